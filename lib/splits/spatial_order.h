// Neighbours in space become neighbours in memory.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/math/bounds.h"
#include "occlod/mesh/triangle_mesh.h"
#include "splits/position_view.h"

namespace occlod {

// The same mesh with its vertices along a Morton curve through its box; triangles keep their order. O(n).
[[nodiscard]] TriangleMesh in_spatial_order(const TriangleMesh& mesh, unsigned threads = 1);

// The wedges of a mesh by their new numbers, and the new numbers of its wedges.
struct WedgeOrder {
  std::vector<WedgeId> old_id, new_id;
};

// That of in_spatial_order().
[[nodiscard]] WedgeOrder spatial_order_of(const TriangleMesh& mesh, unsigned threads);

struct MortonCurve {
  Box box;                // around all positions
  glm::dvec3 shift{0.0};  // of its grid, in [0, 1] of the box's extent along each axis: curves with different shifts
                          // cut space in different places
  unsigned bits = 10;     // the grid has 2^bits cells along each axis, over twice the box's extent; at most 10
};

// Sorts vertices along a Morton curve; those in one cell of its grid keep their order. O(n).
void sort_spatially(const PositionView& positions, const MortonCurve& curve, std::span<VertexId> vertices,
                    unsigned threads = 1);

}  // namespace occlod
