// Places of points in octrees that are moved from level to level.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "occlod/math/bounds.h"

namespace occlod::hlod {

// An octree over twice the extent W of a mesh, so that it can be moved by up to two thirds of W and still cover it.
// Coordinates are integers of W / (3 * 2^20), so thirds are exact. A third of W is a third of every cell size, give or
// take whole cells: planes of two octrees that are moved by different thirds stay a third of the smaller cell apart.
class OctreeGrid {
 public:
  static constexpr unsigned depth = 21;  // levels of cells below the root; the finest are 2^-20 W wide

  explicit OctreeGrid(const Box& box);

  // The path from the root to the finest cell that holds p, 3 bits a level, the root's in the highest of 63: a Morton
  // code. `thirds` in {0, 1, 2}: how many thirds of W the octree is moved by, on every axis. Points outside the mesh's
  // box count as on its border.
  [[nodiscard]] std::uint64_t code(const glm::dvec3& p, unsigned thirds) const;

  // Which of its parent's eight cells a code goes through at this depth >= 1.
  [[nodiscard]] static unsigned octant(std::uint64_t code, unsigned at_depth) {
    return static_cast<unsigned>(code >> 3U * (depth - at_depth)) & 7U;
  }

 private:
  glm::dvec3 origin_;
  double units_per_length_ = 0.0;
};

}  // namespace occlod::hlod
