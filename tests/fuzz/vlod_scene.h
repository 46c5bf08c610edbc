// The scene of the .vlod files in the corpus.
#pragma once

#include <array>
#include <glm/gtc/matrix_transform.hpp>

#include "occlod/build_hierarchy.h"
#include "occlod/cell_builder.h"
#include "occlod/generate.h"
#include "occlod/refiner.h"

namespace occlod::fuzz {

// Two planets of a hundred triangles, one of them mirrored and two-sided.
class VlodScene {
 public:
  [[nodiscard]] std::array<RefineObject, 2> objects() const {
    const glm::dmat4 beside = glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, 2.5, 0.0));
    return {{{.hierarchy = &planet_},
             {.hierarchy = &planet_,
              .object_to_world = glm::scale(beside, glm::dvec3(-1.0, 1.0, 1.0)),
              .two_sided = true}}};
  }
  [[nodiscard]] static CellTreeOptions options() {
    CellTreeOptions options;
    options.cell.eyes.focal_length_px = 60.0;
    options.regions = {{{1.5, 0, 0}, {2.5, 1, 0.5}}, {{-2, -2, 0}, {-1.5, -1.5, 0.5}}};
    options.root_cell = 0.5;
    options.smallest_cell = 0.25;
    options.max_triangles = 60;
    options.division = CellDivision::gain;
    return options;
  }

 private:
  Hierarchy planet_ = build_hierarchy(generate("rough-planet", {{"level", 2}}));
};

}  // namespace occlod::fuzz
