// Neighbours in space become neighbours in memory.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// The same mesh with its vertices along a Morton curve through its box and its triangles in the order of their first
// vertices. O(n).
[[nodiscard]] TriangleMesh in_spatial_order(const TriangleMesh& mesh);

// Sorts vertices along a Morton curve; those in one cell of its grid keep their order. The curve's grid is moved by
// `shift`, in [0, 1] of the positions' extent along each axis: curves with different shifts cut space in different
// places. O(n).
void sort_spatially(std::span<const glm::vec3> positions, const glm::dvec3& shift, std::vector<VertexId>& vertices);

}  // namespace occlod
