// What the nodes of level 0 have in common along their borders. Borders of coarser nodes run along the same vertices.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "occlod/hlod/hlod.h"

namespace occlod::tiles {

struct BorderVertex {
  glm::vec3 position{0.0F};
  glm::vec3 normal{0.0F};           // the mean over all triangles of level 0 there, by area; zero where that is
  bool is_at_input_border = false;  // an edge of level 0 that ends here is used by one triangle
};

class BorderVertices {
 public:
  // None.
  BorderVertices() = default;
  // Of all nodes of level 0, which are required. Calls `next` before each. Throws Error when a mapped file is damaged.
  // O(n log n).
  BorderVertices(const hlod::Hlod& hlod, const std::function<void()>& next);

  // Null where no border of a node of level 0 runs through `position`. O(log n).
  [[nodiscard]] const BorderVertex* at(const glm::vec3& position) const;

 private:
  std::vector<BorderVertex> vertices_;  // by position
};

}  // namespace occlod::tiles
