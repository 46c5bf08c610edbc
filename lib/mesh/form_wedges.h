// Gives the corners of a welded mesh their wedges.
#pragma once

#include <vector>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// `mesh` has welded triangles, but still the vertices as read, with their attributes, without NaN; `read_corners` is
// the vertex as read at each corner of each triangle. Vertices that no triangle uses are dropped, the others keep their
// order. Corners of a vertex whose attributes and material are equal (+0 and -0 are) share a wedge; the first wedge of
// a vertex is that of the first triangle that uses it, the others follow in the order of their first use. Returns
// false, with `mesh` as it was, where ids cannot count the wedges. Expected O(n).
[[nodiscard]] bool form_wedges(TriangleMesh& mesh, std::vector<Triangle> read_corners);

}  // namespace occlod
