#include "hlod/build/octree_grid.h"

#include <algorithm>

namespace occlod::hlod {
namespace {

constexpr std::uint32_t units_of_third = 1U << 20U;
constexpr std::uint32_t units = 3 * units_of_third;  // of W

// Spreads the lower 21 bits of x to every third bit.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32U) & 0x001f00000000ffffU;
  x = (x | x << 16U) & 0x001f0000ff0000ffU;
  x = (x | x << 8U) & 0x100f00f00f00f00fU;
  x = (x | x << 4U) & 0x10c30c30c30c30c3U;
  return (x | x << 2U) & 0x1249249249249249U;
}

}  // namespace

OctreeGrid::OctreeGrid(const Box& box) : origin_(box.min) {
  const glm::dvec3 size = glm::dvec3(box.max) - origin_;
  const double extent = std::max({size.x, size.y, size.z});
  if (extent > 0.0) units_per_length_ = units / extent;
}

std::uint64_t OctreeGrid::code(const glm::dvec3& p, unsigned thirds) const {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double x = std::clamp((p[axis] - origin_[axis]) * units_per_length_, 0.0, static_cast<double>(units - 1));
    const std::uint32_t moved = static_cast<std::uint32_t>(x) + thirds * units_of_third;
    code |= spread(moved / 3) << static_cast<unsigned>(axis);  // cells of the finest level are 3 units wide
  }
  return code;
}

}  // namespace occlod::hlod
