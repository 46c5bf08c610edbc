// Declares a stable, multi-threaded radix sort.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "base/memory.h"
#include "occlod/bounds.h"
#include "occlod/mesh.h"
#include "splits/positions.h"

namespace occlod {

struct Keyed {
  std::uint32_t key;
  std::uint32_t item;
};

// Sorts by ascending key; all keys are below 2^key_bits, and equal keys keep their order. The result does not depend on
// the number of threads. O(n).
void sort_by_key(UninitializedVector<Keyed>& items, unsigned key_bits, unsigned threads);

// Reorders vertices so that neighbours in space are neighbours in memory.

// Returns the same mesh with its vertices along a Morton curve through its box; triangles keep their order. O(n).
[[nodiscard]] TriangleMesh in_spatial_order(const TriangleMesh& mesh, unsigned threads = 1);

// Maps new wedge numbers to wedges of a mesh and back.
struct WedgeOrder {
  std::vector<WedgeId> old_id, new_id;
};

// Returns the order along the curve of in_spatial_order(), where vertices in one cell keep the order of `vertices`,
// which has all of them; in_spatial_order() has them ascending.
[[nodiscard]] WedgeOrder spatial_order_of(const TriangleMesh& mesh, std::vector<VertexId> vertices, unsigned threads);

// Returns all vertices below `count` in the order in which triangles first use them, then those that none uses. O(n).
[[nodiscard]] std::vector<VertexId> in_order_of_use(std::span<const Triangle> triangles, std::size_t count);

struct MortonCurve {
  Box box;  // around all positions
  // shift of the grid, in [0, 1] of the box's extent along each axis; different shifts cut space in different places
  glm::dvec3 shift{0.0};
  unsigned bits = 10;  // the grid has 2^bits cells along each axis, over twice the box's extent; at most 10
};

// Sorts vertices along a Morton curve; vertices in one cell of its grid keep their order. O(n).
void sort_spatially(const PositionView& positions, const MortonCurve& curve, std::span<VertexId> vertices,
                    unsigned threads = 1);

// Computes codes of positions along a Morton curve.

// Spreads the lower 10 bits of x to every third bit.
[[nodiscard]] inline std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffU;
  x = (x | x << 8) & 0x0300f00fU;
  x = (x | x << 4) & 0x030c30c3U;
  return (x | x << 2) & 0x09249249U;
}

// Maps positions to codes of 3 * bits bits along a MortonCurve.
class MortonGrid {
 public:
  explicit MortonGrid(const MortonCurve& curve) {
    const glm::dvec3 size = glm::dvec3(curve.box.max) - glm::dvec3(curve.box.min);
    const double extent = std::max({size.x, size.y, size.z});
    const double cells = static_cast<double>(1U << curve.bits);
    last_cell_ = static_cast<float>(cells - 1.0);
    origin_ = glm::vec3(glm::dvec3(curve.box.min) - curve.shift * extent);
    // Stay finite also where the extent is denormal: cells are wider than it then.
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
