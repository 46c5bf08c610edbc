// Boxes of tiles, in double precision: contents may lie beside the floats of the HLOD.
#pragma once

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace occlod::tiles {

// Of nothing, at first.
struct TileBox {
  glm::dvec3 min{std::numeric_limits<double>::infinity()};
  glm::dvec3 max{-std::numeric_limits<double>::infinity()};

  [[nodiscard]] bool is_empty() const noexcept { return !(min.x <= max.x); }
  void take(const glm::dvec3& point) {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
  void take(const TileBox& box) {
    min = glm::min(min, box.min);
    max = glm::max(max, box.max);
  }
};

// No thinner than a millionth of its largest extent, and no point: some clients cannot do with a flat box.
[[nodiscard]] inline TileBox thickened(TileBox box) {
  const glm::dvec3 extent = box.max - box.min;
  const glm::dvec3 farthest = glm::max(glm::abs(box.min), glm::abs(box.max));
  const double largest =
      std::max({extent.x, extent.y, extent.z, 1e-6 * std::max({farthest.x, farthest.y, farthest.z})});
  const double least = largest > 0.0 ? 1e-6 * largest : 1e-6;
  for (int k = 0; k < 3; ++k) {
    if (extent[k] >= least) continue;
    box.min[k] -= least / 2.0;
    box.max[k] += least / 2.0;
  }
  return box;
}

}  // namespace occlod::tiles
