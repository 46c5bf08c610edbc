// What a mesh looks like, for the mesh that was made of it.
#pragma once

#include <vector>

#include "occlod/mesh.h"

namespace occlod::repair {

// `repaired` has positions and triangles; `sources`: the vertex of `soup` that each of its vertices is a copy of. In
// `soup`, triangles name vertices that may have been welded, `corners` the wedges as they were. Triangles that are
// still there keep the wedges of their corners and their material; new ones get the first wedge of each vertex, and the
// material that the first wedge of their first vertex has. Throws Error when there are too many wedges. Expected O(n).
void give_attributes(TriangleMesh& repaired, const std::vector<VertexId>& sources, const TriangleMesh& soup);

}  // namespace occlod::repair
