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

// Welds vertices with bit-identical positions (+0 and -0 are one), drops triangles with a repeated corner and vertices
// that no triangle uses, and counts the topology of the rest. Vertices and triangles keep their order. Corners of a
// vertex that differ in normal, colour, texture coordinate or material get wedges of their own; `corners` and
// `extra_wedges` are empty where none do. A vertex's first wedge is that of the first triangle that uses it; the others
// follow in the order of their first use. `triangle_materials` is empty where all triangles have the first material.
//
// Normals come out with unit length, and one that has it but for rounding keeps its bits; one that is zero or not
// finite is computed from the triangles at its position. A texture coordinate that is not finite becomes (0, 0) and
// counts in left_out. So cleaning what was cleaned changes no bit. `mesh` may be as read, with a vertex for each set of
// attributes, or have wedges, which are formed anew.
//
// `report` holds what the reader counted and is completed; an empty one is filled as if `mesh` had been read. Vertices
// from report.vertices_read on count as wedges of those before. `subject` names the mesh in errors. Throws Error when a
// triangle uses a vertex that is not finite or beyond farthest_coordinate, for an index out of range, or when no
// triangle is left. Expected O(n).
[[nodiscard]] CleanMesh clean(TriangleMesh mesh, const MeshReport& report, const std::string& subject);

}  // namespace occlod
