// Gives a repaired mesh the attributes of the mesh that it was made of.
#pragma once

#include <vector>

#include "occlod/mesh.h"

namespace occlod::repair {

// `repaired` has positions and triangles, and `sources` the vertex of `soup` that each of its vertices is a copy of. In
// `soup`, triangles name vertices that may have been welded, and `corners` the original wedges. Triangles that still
// exist keep the wedges of their corners and their material; new ones get the first wedge of each vertex, and the
// material of the first wedge of their first vertex. Throws Error when there are too many wedges. Expected O(n).
void give_attributes(TriangleMesh& repaired, const std::vector<VertexId>& sources, const TriangleMesh& soup);

}  // namespace occlod::repair
