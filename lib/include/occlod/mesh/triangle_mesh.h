// An indexed triangle mesh: what readers and generators make and what hierarchies are built from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "occlod/core/ids.h"

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

}  // namespace occlod
