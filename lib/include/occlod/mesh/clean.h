// Turns what a file holds into a mesh that a hierarchy can be built from: welded, finite, without degenerate indices.
#pragma once

#include <string>

#include "occlod/mesh/mesh_report.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// A mesh and what was found in it.
struct CleanMesh {
  TriangleMesh mesh;  // welded, as clean() leaves it
  MeshReport report;  // what was found and changed
};

// Welds vertices with bit-identical positions (+0 and -0 are one), averages their attributes, drops triangles
// with a repeated corner and vertices that no triangle uses, and counts the topology of the rest. Vertices and
// triangles keep their order. Normals come out with unit length; one that is zero or not finite is computed from its
// triangles. `report` holds what the reader counted and is completed; an empty one is filled as if `mesh` had been
// read. `subject` names the mesh in errors. Throws Error when a triangle uses a vertex that is not finite or beyond
// farthest_coordinate or an index out of range, or when no triangle is left. Expected O(n).
[[nodiscard]] CleanMesh clean(TriangleMesh mesh, const MeshReport& report, const std::string& subject);

}  // namespace occlod
