// Codes of positions along a Morton curve.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>

#include "splits/spatial_order.h"

namespace occlod {

// Spreads the lower 10 bits of x to every third bit.
[[nodiscard]] inline std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffU;
  x = (x | x << 8) & 0x0300f00fU;
  x = (x | x << 4) & 0x030c30c3U;
  return (x | x << 2) & 0x09249249U;
}

// Positions to places along a MortonCurve, in 3 * bits bits.
class MortonGrid {
 public:
  explicit MortonGrid(const MortonCurve& curve) {
    const glm::dvec3 size = glm::dvec3(curve.box.max) - glm::dvec3(curve.box.min);
    const double extent = std::max({size.x, size.y, size.z});
    const double cells = static_cast<double>(1U << curve.bits);
    last_cell_ = static_cast<float>(cells - 1.0);
    origin_ = glm::vec3(glm::dvec3(curve.box.min) - curve.shift * extent);
    // Finite also where the extent is denormal: cells are wider than it then.
    constexpr double most = std::numeric_limits<float>::max();
    cells_per_unit_ = extent > 0.0 ? static_cast<float>(std::min(cells / (2.0 * extent), most)) : 0.0F;
  }
  [[nodiscard]] std::uint32_t code(const glm::vec3& p) const {
    const glm::vec3 cell = glm::min((p - origin_) * cells_per_unit_, last_cell_);
    return spread_bits(static_cast<std::uint32_t>(cell.x)) | spread_bits(static_cast<std::uint32_t>(cell.y)) << 1 |
           spread_bits(static_cast<std::uint32_t>(cell.z)) << 2;
  }

 private:
  glm::vec3 origin_{0.0F};
  float cells_per_unit_ = 0.0F;
  float last_cell_ = 0.0F;
};

}  // namespace occlod
