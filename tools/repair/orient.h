// Orients each piece of a triangle soup consistently, and makes all edges and vertices manifold.
#pragma once

#include "repair/halfedge_mesh.h"
#include "repair/repair.h"

namespace occlod::repair {

// No two triangles may have the same corners. Counts triangles_turned, vertices_duplicated, unorientable_edges and
// edges_stitched.
[[nodiscard]] HalfedgeMesh oriented_mesh(Soup soup, RepairCounts& counts);

}  // namespace occlod::repair
