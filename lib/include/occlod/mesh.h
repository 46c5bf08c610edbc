// Indexed triangle meshes: what readers and generators make and what hierarchies are built from. clean() prepares them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "occlod/base.h"
#include "occlod/bounds.h"

namespace occlod {

using FeatureId = std::uint32_t;  // indexes TriangleMesh::feature_names or HlodFeatures::names
using Triangle = glm::u32vec3;    // three vertex ids, counter-clockwise seen from outside

// Meshes with larger coordinates are refused: bounds and errors reach a few times the diagonal and must fit in floats.
inline constexpr float farthest_coordinate = 1.5e37F;

// Where a mesh has the origin of its texture coordinates. Readers keep coordinates as they are.
enum class TextureOrigin : std::uint8_t {
  bottom_left,  // OBJ, PLY: v grows upwards
  top_left      // glTF: v grows downwards
};

// The axis that points up, as far as the format of a file says: y in glTF, z in the others, which do not say.
enum class UpAxis : std::uint8_t { z, y };

// How a texture continues beyond [0, 1].
enum class TextureWrap : std::uint8_t { repeat, clamp, mirror };

// An image that materials name. The library stores and passes it on; only programs that draw decode it.
struct Texture {
  std::string file;                          // as the mesh file names it, relative to that file; empty when embedded
  std::string mime_type;                     // MIME type of `bytes`, such as image/png; empty without `bytes`
  std::vector<std::uint8_t> bytes;           // the encoded image when the mesh file holds it; else empty
  TextureWrap wrap_s = TextureWrap::repeat;  // along the first coordinate
  TextureWrap wrap_t = TextureWrap::repeat;  // along the second coordinate
  std::uint16_t min_filter = 0;              // how glTF names it for an image that is small on screen, such as 9987 for
                                             // trilinear; 0: the program that draws chooses
  std::uint16_t mag_filter = 0;              // likewise for a large one
  // True when all fields are equal.
  [[nodiscard]] bool operator==(const Texture&) const = default;
};

// How the alpha of a base colour and its texture counts.
enum class AlphaMode : std::uint8_t {
  by_color,  // blends if the alpha of Material::base_color is below 1; else alpha is ignored
  mask,      // shows what has at least Surface::alpha_cutoff, and nothing of the rest
  blend      // shows what is behind, as far as alpha is below 1
};

// An image beside that of the base colour, which is looked up with the mesh's texture coordinates.
struct TextureMap {
  TextureId texture = no_texture;  // indexes the mesh's textures
  float strength = 1.0F;           // of normals, where glTF calls it scale, and of occlusion
  // The place in the image, v growing downwards: rotation * (scale * (u, v)) + offset, as in KHR_texture_transform.
  glm::vec2 offset = {0.0F, 0.0F};
  float rotation = 0.0F;           // radians, counter-clockwise
  glm::vec2 scale = {1.0F, 1.0F};  // see offset
  // True when all fields are equal.
  [[nodiscard]] bool operator==(const TextureMap&) const = default;
};

// The look of a surface beyond its base colour, as glTF 2.0 describes it. It is stored and passed on; pictures do not
// show it.
struct Surface {
  AlphaMode alpha_mode = AlphaMode::by_color;  // of the base colour and its texture
  float alpha_cutoff = 0.5F;                   // with AlphaMode::mask
  bool double_sided = false;                   // whether its back shows
  bool unlit = false;                          // shows the base colour whatever the light is: KHR_materials_unlit
  float metallic = 0.0F;                       // in [0, 1]; multiplies the blue of its map
  float roughness = 1.0F;                      // in [0, 1]; multiplies the green of its map
  glm::vec3 emissive{0.0F};                    // linear light, in [0, 1]; multiplies its map
  TextureMap metallic_map;                     // of `metallic` and `roughness`
  TextureMap normal_map;                       // in tangent space
  TextureMap occlusion_map;                    // of ambient light
  TextureMap emissive_map;                     // of `emissive`
  // True when all fields are equal.
  [[nodiscard]] bool operator==(const Surface&) const = default;
};

// The look of a surface.
struct Material {
  std::string name;                                 // as in the file; may be empty
  glm::vec4 base_color = {1.0F, 1.0F, 1.0F, 1.0F};  // linear light and alpha, in [0, 1]; multiplies the texture
  TextureId texture = no_texture;                   // the texture of the base colour: indexes the mesh's textures
  Surface surface = {};                             // what glTF knows beside the base colour
  // Returns the texture of the base colour and those of the maps; no_texture for each that is not there.
  [[nodiscard]] std::array<TextureId, 5> textures() const noexcept {
    return {texture, surface.metallic_map.texture, surface.normal_map.texture, surface.occlusion_map.texture,
            surface.emissive_map.texture};
  }
  // Returns the first of these that is not among `count` textures; no_texture: all are.
  [[nodiscard]] TextureId texture_beyond(std::size_t count) const noexcept {
    for (const TextureId id : textures())
      if (id != no_texture && id >= count) return id;
    return no_texture;
  }
  // True when all fields are equal.
  [[nodiscard]] bool operator==(const Material&) const = default;
};

// A mesh as plain indexed arrays. It is valid when every index is in range and every optional array is empty or has one
// entry per wedge; clean() makes it so.
//
// A wedge is a vertex with one set of attributes. Wedge v < vertex_count() is the first wedge of vertex v. A vertex on
// a seam has more: wedge vertex_count() + i is another wedge of vertex extra_wedges[i], and positions repeats that
// vertex's position for it, so that the arrays can be drawn as they are, with `corners` as indices. Without extra
// wedges, wedges and vertices are the same and `triangles` is all that is needed.
struct TriangleMesh {
  std::vector<glm::vec3> positions;            // object space, relative to `origin`, object units; one per wedge
  std::vector<glm::vec3> normals;              // unit length; empty or one per wedge
  std::vector<glm::u8vec4> colors;             // sRGB and alpha; empty or one per wedge
  std::vector<glm::vec2> texture_coordinates;  // as the file has them; empty or one per wedge
  std::vector<VertexId> extra_wedges;          // the vertices of the extra wedges, ascending
  std::vector<Triangle> triangles;             // every index < vertex_count()
  std::vector<Triangle> corners;  // by triangle: a wedge of each of its vertices; empty when there are no extra wedges
  std::vector<MaterialId> triangle_materials;  // one per triangle; empty: all have the first, if any. All triangles
                                               // that use a wedge have the same material
  std::vector<Material> materials;             // indexed by triangle_materials
  std::vector<Texture> textures;               // indexed by materials
  TextureOrigin texture_origin = TextureOrigin::bottom_left;  // origin of texture_coordinates
  // What positions are relative to: coordinates are origin + position. Not 0 where coordinates have more digits than
  // floats, such as those of maps: readers then choose a place near the middle of the mesh.
  glm::dvec3 origin{0.0};
  UpAxis up = UpAxis::z;  // of the file or scene that it comes from
  // Which part of the input each triangle belongs to: a group or object of an OBJ file, a node of a glTF file. HLODs
  // and tilesets keep it; what is made of a mesh otherwise does not. Wedges may be shared by features.
  std::vector<FeatureId> triangle_features;  // one per triangle; empty: all have the first, if any
  std::vector<std::string> feature_names;    // UTF-8, as in the file; may be empty or equal; indexed by
                                             // triangle_features

  // Returns the number of vertices; extra wedges do not count.
  [[nodiscard]] std::size_t vertex_count() const noexcept { return positions.size() - extra_wedges.size(); }
  // Returns the number of wedges, including the first of each vertex.
  [[nodiscard]] std::size_t wedge_count() const noexcept { return positions.size(); }
  // Returns the number of triangles.
  [[nodiscard]] std::size_t triangle_count() const noexcept { return triangles.size(); }
  // Returns the vertex of a wedge.
  [[nodiscard]] VertexId vertex_of(WedgeId wedge) const noexcept {
    return wedge < vertex_count() ? wedge : extra_wedges[wedge - vertex_count()];
  }
  // Returns the triangles to draw: `corners`, or `triangles` when there are no extra wedges.
  [[nodiscard]] const std::vector<Triangle>& wedge_triangles() const noexcept {
    return corners.empty() ? triangles : corners;
  }
  // Returns the material of triangle t, an index into materials; also 0 when there are none.
  [[nodiscard]] MaterialId material_of(std::size_t t) const noexcept {
    return triangle_materials.empty() ? MaterialId{0} : triangle_materials[t];
  }
  // Returns the feature of triangle t, an index into feature_names; also 0 when there are none.
  [[nodiscard]] FeatureId feature_of(std::size_t t) const noexcept {
    return triangle_features.empty() ? FeatureId{0} : triangle_features[t];
  }
};

// Moves the origin of a mesh: coordinates stay where they are, to the nearest floats. O(vertices).
void move_origin(TriangleMesh& mesh, const glm::dvec3& origin);

// Returns the transform that places the positions of a mesh with this origin, when `object_to_world` places its
// coordinates: what all scenes, refiners, traversers and pictures expect.
[[nodiscard]] glm::dmat4 positions_to_world(const glm::dmat4& object_to_world, const glm::dvec3& origin);

// Sets positions, and the origin where floats would lose digits: they would move a coordinate that triangles use, if
// there are any, by more than a millionth of the largest side of the box around these. O(n).
void set_coordinates(TriangleMesh& mesh, std::span<const glm::dvec3> coordinates);

// Counts what a file holds and a TriangleMesh does not, by name and in the file's own terms: "facet normals",
// "lines (l)", "property quality of vertex". Attributes that corners of triangles use are kept; they count only when no
// corner uses them.
class LeftOut {
 public:
  // A name and its count.
  struct Entry {
    std::string name;         // in the words of the file
    std::uint64_t count = 0;  // at least 1
    // True when name and count are equal.
    [[nodiscard]] bool operator==(const Entry&) const = default;
  };

  static constexpr std::size_t max_names = 256;       // without "others"
  static constexpr std::size_t max_name_bytes = 128;  // of a name

  // Adds to the count of a name; a count of 0 changes nothing. Files may name things as they like: control characters
  // become '?', a long name is cut to max_name_bytes, and when there are max_names names, new ones count as "others".
  // O(names).
  void add(std::string_view name, std::uint64_t count = 1);
  // Adds all counts of another object.
  void add(const LeftOut& more);

  // Returns the count of a name, 0 where it has none. O(log names).
  [[nodiscard]] std::uint64_t count(std::string_view name) const noexcept;
  // True when nothing was left out.
  [[nodiscard]] bool empty() const noexcept { return entries_.empty(); }
  // Returns the counts, ascending by name.
  [[nodiscard]] std::span<const Entry> entries() const noexcept { return entries_; }
  // True when all names and counts are equal.
  [[nodiscard]] bool operator==(const LeftOut&) const = default;

 private:
  std::vector<Entry> entries_;  // ascending by name
};

// Counts what was found in an input mesh and what was changed: the file as it was read, the changes of clean(), and the
// topology of the welded mesh, from which a hierarchy is built.
struct MeshReport {
  // Counts of the file as it was read.
  std::uint64_t vertices_read = 0;
  std::uint64_t polygons_read = 0;          // faces of any size in the file; each triangle of a strip counts
  std::uint64_t polygons_triangulated = 0;  // faces with more than three corners, cut into triangles
  std::uint64_t triangles_read = 0;         // after triangulation
  // Counts of what clean() changed.
  std::uint64_t vertices_welded = 0;        // merged into another with exactly the same position
  std::uint64_t seam_vertices = 0;          // vertices with more than one wedge, see TriangleMesh
  std::uint64_t unreferenced_vertices = 0;  // used by no triangle; dropped
  std::uint64_t nonfinite_vertices = 0;     // NaN or infinite and unreferenced; dropped (a referenced one is an error)
  std::uint64_t repeated_index_triangles = 0;  // two corners at one position after welding; dropped
  // Topology of the welded mesh, which clean() does not change.
  std::uint64_t zero_area_triangles = 0;   // three different corners on one line
  std::uint64_t repeated_triangles = 0;    // the same three corners as an earlier triangle, in any order
  std::uint64_t boundary_edges = 0;        // used by one triangle
  std::uint64_t nonmanifold_edges = 0;     // used by three or more triangles
  std::uint64_t inconsistent_edges = 0;    // two triangles run through it in the same direction
  std::uint64_t nonmanifold_vertices = 0;  // vertices whose triangles form more than one fan
  std::uint64_t components = 0;            // connected through shared vertices
  LeftOut left_out;                        // in the file and not in the mesh
};

// A mesh and what was found and changed when it was cleaned.
struct CleanMesh {
  TriangleMesh mesh;  // welded, as clean() leaves it
  MeshReport report;  // what was found and changed
};

// Turns what a file holds into a mesh from which a hierarchy can be built. Welds vertices with bit-identical positions
// (+0 and -0 are equal), drops triangles with a repeated corner and vertices that no triangle uses, and counts the
// topology of the result. Vertices and triangles keep their order. Corners of a vertex that differ in normal, colour,
// texture coordinate or material get separate wedges; `corners` and `extra_wedges` are empty when there are none. A
// vertex's first wedge is that of the first triangle that uses it; the others follow in the order of their first use.
// `triangle_materials` is empty when all triangles have the first material. Features stay with their triangles.
//
// Normals get unit length; one that already has it, up to rounding, keeps its bits, and one that is zero or not finite
// is computed from the triangles at its position. A texture coordinate that is not finite becomes (0, 0) and counts in
// left_out. Cleaning a cleaned mesh changes no bit. `mesh` may be as read, with a vertex for each set of attributes, or
// have wedges, which are formed anew.
//
// `report` holds the reader's counts; the result completes them. An empty report is filled as if `mesh` had been read.
// Vertices from report.vertices_read on count as wedges of earlier ones. `subject` names the mesh in errors. Throws
// Error when a triangle uses a vertex that is not finite or beyond farthest_coordinate, for an index out of range, or
// when no triangle is left. `threads` is the number of threads to use, 0 for one per core; the result does not depend
// on it. Expected O(n).
[[nodiscard]] CleanMesh clean(TriangleMesh mesh, const MeshReport& report, const std::string& subject, int threads = 0);

// Counts edges, fans and components of a mesh with valid indices into the topology fields of `report`. `threads` is as
// for clean(). O(n).
void count_topology(const TriangleMesh& mesh, MeshReport& report, int threads = 0);

// Returns the mesh with new normals, smooth over surfaces and hard at creases, for meshes without normals or with bad
// ones. Indices must be valid. Two triangles are smoothed across their common edge when the angle between them is at
// most `degrees`, in [0, 180], and no third triangle uses the edge. Triangles around a vertex that are joined through
// such edges share a normal, their area-weighted mean; a vertex with several such groups gets a wedge for each.
// Everything else about the corners stays; the result is as clean() leaves it. 0 gives flat faces, where coplanar ones
// still share normals; 180 smooths everything. Throws Error for an angle out of range and for what clean() refuses. O(n
// log v) for v triangles around a vertex.
[[nodiscard]] TriangleMesh crease_normals(const TriangleMesh& mesh, double degrees);

// Returns the mesh with one set of attributes per vertex, so without extra wedges. A vertex gets the mean of its
// wedges' colours and of their normals, scaled to unit length (the first normal when they cancel out). Texture
// coordinates and materials have no useful mean and are dropped. A mesh without extra wedges keeps its normals and
// colours to the bit. O(n).
[[nodiscard]] TriangleMesh merge_wedges(const TriangleMesh& mesh);

// Returns the smallest power of two that divides the box's longest side into at most 2^bits steps, but no finer step
// than floats have at the box's farthest corner. Positions on such a lattice take fewer bytes in files. Returns 0 for a
// box without extent. `bits` is in [1, 30]. O(1).
[[nodiscard]] float lattice_step(const Box& box, int bits);

// Rounds each coordinate to the nearest multiple of `step`, ties to the even multiple, so that equal positions stay
// equal. `step` is from lattice_step() for a box that contains p; 0 leaves p as it is. No coordinate moves by more than
// half a step.
[[nodiscard]] glm::vec3 round_to_lattice(const glm::vec3& p, float step);

// Rounds all positions of a mesh to the lattice. Positions may become equal, so clean() the mesh before use.
// O(vertices).
void round_to_lattice(TriangleMesh& mesh, float step);

}  // namespace occlod
