// Makes do with one set of attributes for each vertex.
#pragma once

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// A mesh without extra wedges: a vertex gets the mean of its wedges' normals, brought to unit length (its first one
// where they cancel out), and of their colours. Texture coordinates and materials, of which there is no mean, are
// dropped. A mesh without extra wedges keeps its normals and colours to the bit. O(n).
[[nodiscard]] TriangleMesh merge_wedges(const TriangleMesh& mesh);

}  // namespace occlod
