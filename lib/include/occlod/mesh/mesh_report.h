// What was found in an input mesh and what was done about it.
#pragma once

#include <cstdint>

namespace occlod {

// What a file holds and a TriangleMesh does not. What corners of triangles take is kept; it counts here only where none
// does.
struct LeftOut {
  // All: vertices with one that is not finite, which becomes (0, 0). OBJ: vt lines that no face uses. PLY: vertices
  // that have one, where faces do too. OFF: vertices of STOFF files. glTF: vertices, once for each of their TEXCOORD_n
  // but the one that the base colour's texture names.
  std::uint64_t texture_coordinates = 0;
  // OBJ: vn lines that no face uses. PLY: faces that have one. STL: facets.
  std::uint64_t normals = 0;
  // PLY and OFF: faces that have one. STL: binary facets whose attribute bytes are not 0, which is how programs colour
  // them. glTF: vertices, once for each of their COLOR_n beyond COLOR_0.
  std::uint64_t colors = 0;
  // OBJ: names on usemtl lines that no library of the mtllib lines describes; their names are kept. PLY: elements
  // `material`. glTF: textures of materials that are not of the base colour.
  std::uint64_t materials = 0;
  // OBJ: different names on o lines, and on g lines. STL: different names of solids (text). glTF: nodes with a mesh.
  std::uint64_t groups = 0;

  // Whether all counts are the same.
  [[nodiscard]] bool operator==(const LeftOut&) const = default;
};

// Counts over one mesh: of the file as it was read, of what clean() changed, and of the topology of the welded mesh,
// from which a hierarchy is built.
struct MeshReport {
  // As read.
  std::uint64_t vertices_read = 0;
  std::uint64_t polygons_read = 0;          // faces of any size in the file, each triangle of its strips
  std::uint64_t polygons_triangulated = 0;  // faces with more than three corners, cut into triangles
  std::uint64_t triangles_read = 0;         // after triangulation
  // Changed by clean().
  std::uint64_t vertices_welded = 0;        // merged into another with exactly the same position
  std::uint64_t seam_vertices = 0;          // with more than one wedge (mesh/triangle_mesh.h)
  std::uint64_t unreferenced_vertices = 0;  // used by no triangle; dropped
  std::uint64_t nonfinite_vertices = 0;     // NaN or infinite and unreferenced; dropped (a referenced one is an error)
  std::uint64_t repeated_index_triangles = 0;  // two corners at one position after welding; dropped
  // Topology of the welded mesh, kept as it is.
  std::uint64_t zero_area_triangles = 0;   // three different corners on one line
  std::uint64_t repeated_triangles = 0;    // the same three corners as an earlier triangle, in any order
  std::uint64_t boundary_edges = 0;        // used by one triangle
  std::uint64_t nonmanifold_edges = 0;     // used by three or more triangles
  std::uint64_t inconsistent_edges = 0;    // two triangles run through it in the same direction
  std::uint64_t nonmanifold_vertices = 0;  // vertices whose triangles form more than one fan
  std::uint64_t components = 0;            // connected through shared vertices
  LeftOut left_out;                        // in the file and not in the mesh
};

}  // namespace occlod
