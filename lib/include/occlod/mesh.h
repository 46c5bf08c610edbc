// An indexed triangle mesh: what readers and generators make and what hierarchies are built from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/bounds.h"

namespace occlod {

using Triangle = glm::u32vec3;  // three vertex ids, counter-clockwise seen from outside

// Meshes with larger coordinates are refused: bounds and errors reach a few times the diagonal, and are floats.
inline constexpr float farthest_coordinate = 1.5e37F;

// Where a mesh says that the origin of its texture coordinates is. Readers keep coordinates as they are.
enum class TextureOrigin : std::uint8_t {
  bottom_left,  // OBJ, PLY: v grows upwards
  top_left      // glTF: v grows downwards
};

// What repeats beyond [0, 1].
enum class TextureWrap : std::uint8_t { repeat, clamp, mirror };

// An image that materials name. The library stores and passes it on; only programs that draw decode it.
struct Texture {
  std::string file;                          // as the mesh file names it, relative to that file; empty when embedded
  std::string mime_type;                     // of `bytes`, such as image/png; empty without
  std::vector<std::uint8_t> bytes;           // the encoded image where the mesh file holds it; else empty
  TextureWrap wrap_s = TextureWrap::repeat;  // along the first coordinate
  TextureWrap wrap_t = TextureWrap::repeat;  // along the second
  // Whether all is the same.
  [[nodiscard]] bool operator==(const Texture&) const = default;
};

// How a surface looks, as far as a base colour says it.
struct Material {
  std::string name;                                 // as in the file; may be empty
  glm::vec4 base_color = {1.0F, 1.0F, 1.0F, 1.0F};  // linear light and alpha, in [0, 1]; multiplies the texture
  TextureId texture = no_texture;                   // of the base colour; an index into the mesh's textures
  // Whether all is the same.
  [[nodiscard]] bool operator==(const Material&) const = default;
};

// Plain indexed arrays. Valid when every index is in range and every optional array is empty or has one entry per
// wedge; clean() makes it so.
//
// A wedge is a vertex with one set of attributes. Wedge v < vertex_count() is the first of vertex v. A vertex on a seam
// has more: wedge vertex_count() + i is another of vertex extra_wedges[i], and positions holds that vertex's place
// again, so that the arrays can be drawn as they are, with `corners` as indices. Without extra wedges a wedge is a
// vertex, and `triangles` alone says all.
struct TriangleMesh {
  std::vector<glm::vec3> positions;            // object space, object units; one per wedge
  std::vector<glm::vec3> normals;              // unit length; empty or one per wedge
  std::vector<glm::u8vec4> colors;             // sRGB and alpha; empty or one per wedge
  std::vector<glm::vec2> texture_coordinates;  // as the file has them; empty or one per wedge
  std::vector<VertexId> extra_wedges;          // their vertices, ascending
  std::vector<Triangle> triangles;             // every index < vertex_count()
  std::vector<Triangle> corners;  // by triangle: a wedge of each of its vertices; empty when there are no extra wedges
  std::vector<MaterialId> triangle_materials;  // by triangle; empty: all have the first, if any. A wedge's are the same
  std::vector<Material> materials;             // that triangle_materials indexes
  std::vector<Texture> textures;               // that materials index
  TextureOrigin texture_origin = TextureOrigin::bottom_left;  // of texture_coordinates

  // Number of vertices: of positions without those of extra wedges.
  [[nodiscard]] std::size_t vertex_count() const noexcept { return positions.size() - extra_wedges.size(); }
  // Number of wedges, the first of each vertex among them.
  [[nodiscard]] std::size_t wedge_count() const noexcept { return positions.size(); }
  // Number of triangles.
  [[nodiscard]] std::size_t triangle_count() const noexcept { return triangles.size(); }
  // The vertex of a wedge.
  [[nodiscard]] VertexId vertex_of(WedgeId wedge) const noexcept {
    return wedge < vertex_count() ? wedge : extra_wedges[wedge - vertex_count()];
  }
  // What to draw: `corners`, or `triangles` when there are no extra wedges.
  [[nodiscard]] const std::vector<Triangle>& wedge_triangles() const noexcept {
    return corners.empty() ? triangles : corners;
  }
  // Of triangle t: an index into materials. 0 too when there are none.
  [[nodiscard]] MaterialId material_of(std::size_t t) const noexcept {
    return triangle_materials.empty() ? MaterialId{0} : triangle_materials[t];
  }
};

// What was found in an input mesh and what was done about it.

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

// Turns what a file holds into a mesh that a hierarchy can be built from: welded, finite, without degenerate indices.

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
// triangle is left. `threads`: that it may use, 0: one for each core; the result does not depend on it. Expected O(n).
[[nodiscard]] CleanMesh clean(TriangleMesh mesh, const MeshReport& report, const std::string& subject, int threads = 0);

// Counts edges, fans and components of a mesh.

// Counts the topology fields of a mesh with valid indices into `report`. `threads` as for clean().
// O(n).
void count_topology(const TriangleMesh& mesh, MeshReport& report, int threads = 0);

// Normals for meshes that have none: smooth over surfaces, hard at their edges.

// Replaces the normals of a mesh with valid indices: two triangles of an edge smooth into each other where the angle
// between them is at most `degrees`, in [0, 180], and no third triangle uses the edge. Triangles round a vertex that
// are joined through such edges share a normal, the mean of theirs by area; a vertex with several such groups gets a
// wedge for each. Everything else about the corners stays; the result is as clean() leaves it. 0 gives flat faces, of
// which coplanar ones are joined; 180 smooths everything. Throws Error for an angle outside and for what clean()
// refuses. O(n log v) for v triangles round a vertex.
[[nodiscard]] TriangleMesh crease_normals(const TriangleMesh& mesh, double degrees);

// Makes do with one set of attributes for each vertex.

// A mesh without extra wedges: a vertex gets the mean of its wedges' normals, brought to unit length (its first one
// where they cancel out), and of their colours. Texture coordinates and materials, of which there is no mean, are
// dropped. A mesh without extra wedges keeps its normals and colours to the bit. O(n).
[[nodiscard]] TriangleMesh merge_wedges(const TriangleMesh& mesh);

// Positions on a lattice, so that they take fewer bytes in files.

// The least power of two of which the box's longest side is at most 2^bits; no finer than floats are at its farthest
// corner. 0 for a box without extent. `bits` in [1, 30]. O(1).
[[nodiscard]] float lattice_step(const Box& box, int bits);

// The multiple of `step` next to each coordinate; of two as near, the even one. `step`: of lattice_step() for a box
// that contains p; 0 leaves p as it is. So the same wherever p occurs. No coordinate moves by more than half a step.
[[nodiscard]] glm::vec3 round_to_lattice(const glm::vec3& p, float step);

// All positions of a mesh: what lies between them may fall together, so clean() it before it is used. O(vertices).
void round_to_lattice(TriangleMesh& mesh, float step);

}  // namespace occlod
