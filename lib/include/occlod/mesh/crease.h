// Normals for meshes that have none: smooth over surfaces, hard at their edges.
#pragma once

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// Replaces the normals of a mesh with valid indices: two triangles of an edge smooth into each other where the angle
// between them is at most `degrees`, in [0, 180], and no third triangle uses the edge. Triangles round a vertex that
// are joined through such edges share a normal, the mean of theirs by area; a vertex with several such groups gets a
// wedge for each. Everything else about the corners stays; the result is as clean() leaves it. 0 gives flat faces, of
// which coplanar ones are joined; 180 smooths everything. Throws Error for an angle outside and for what clean()
// refuses. O(n log v) for v triangles round a vertex.
[[nodiscard]] TriangleMesh crease_normals(const TriangleMesh& mesh, double degrees);

}  // namespace occlod
