// What builders ask of a mesh.
#pragma once

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// Throws Error for a mesh without triangles, with an index out of range or a repeated corner, or with a position that
// is not finite or has a coordinate beyond farthest_coordinate. O(n).
void check_input(const TriangleMesh& mesh);

// Throws Error when two vertices have the same position; +0 and -0 are one. Expected O(n).
void check_welded(const TriangleMesh& mesh);

}  // namespace occlod
