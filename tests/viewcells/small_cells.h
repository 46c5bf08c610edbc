// A scene of view cells that is built in a moment.
#pragma once

#include <array>
#include <filesystem>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <iterator>
#include <string>

#include "occlod/build_cells.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "occlod/vlod_file.h"
#include "support/meshes.h"

namespace occlod::test {

// A wall with spheres behind it, and twice one ball in front of it, one of them mirrored, larger and two-sided.
class SmallCells {
 public:
  [[nodiscard]] std::array<RefineObject, 3> objects() const {
    const glm::dmat4 beside = glm::translate(glm::dmat4(1.0), glm::dvec3(0.4, 1.3, 0.2));
    const glm::dmat4 mirrored =
        glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(0.6, -0.9, 0.1)), glm::dvec3(-0.3, 0.3, 0.3));
    return {{{.hierarchy = &wall_},
             {.hierarchy = &ball_, .object_to_world = glm::scale(beside, glm::dvec3(0.2))},
             {.hierarchy = &ball_, .object_to_world = mirrored, .two_sided = true}}};
  }

  // Five root cells in two regions, some of which are divided: cells of 0.125 to 0.5.
  [[nodiscard]] static CellTreeOptions options() {
    CellTreeOptions options;
    options.cell.eyes.focal_length_px = 300.0;
    options.regions = {{{0.1, -0.5, -0.25}, {0.6, 0.5, 0.25}}, {{-0.3, -1.5, 0.0}, {0.7, -1.25, 0.25}}};
    options.root_cell = 0.5;
    options.smallest_cell = 0.125;
    options.max_triangles = 300;
    options.division = CellDivision::gain;
    options.occluder_motion = 0.01;
    return options;
  }

 private:
  Hierarchy wall_ =
      build_hierarchy(generate("spheres-behind-wall", {{"spheres", 12}, {"level", 2}, {"wall_cells", 6}}));
  Hierarchy ball_ = build_hierarchy(noisy_sphere(2, 3));
};

[[nodiscard]] inline std::string bytes_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace occlod::test
