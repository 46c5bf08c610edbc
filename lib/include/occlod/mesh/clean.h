// From what a file holds to a mesh that a hierarchy can be built from: welded, finite, no degenerate indices.
#pragma once

#include <string>

#include "occlod/mesh/mesh_report.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

struct CleanMesh {
  TriangleMesh mesh;
  MeshReport report;
};

// Welds vertices with bit-identical positions (+0 and -0 are one), averages their attributes, drops triangles
// with a repeated corner and vertices that nothing uses, and counts the topology of what is left. The order of
// the remaining vertices and triangles is kept. Normals come out with unit length; one that is zero or not finite is
// computed from its triangles. `report` carries what the reader counted, the rest is added; an empty one is filled as
// if `mesh` had been read. `subject` names the mesh in errors. Throws Error when a triangle uses a vertex that is not
// finite or beyond farthest_coordinate or an index out of range, or when no triangle is left. Expected O(n).
[[nodiscard]] CleanMesh clean(TriangleMesh mesh, const MeshReport& report, const std::string& subject);

// Counts the topology fields ("kept as they are") of a mesh with valid indices into `report`.
void count_topology(const TriangleMesh& mesh, MeshReport& report);

}  // namespace occlod
