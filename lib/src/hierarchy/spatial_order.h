// Neighbours in space become neighbours in memory.
#pragma once

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// The same mesh with its vertices along a Morton curve through its box and its triangles in the order of their first
// vertices. O(n).
[[nodiscard]] TriangleMesh in_spatial_order(const TriangleMesh& mesh);

}  // namespace occlod
