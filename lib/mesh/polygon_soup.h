// Polygon soups: vertices and polygons as a reader finds them in a file, and the steps that make a triangle mesh of
// them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "base/file_input.h"
#include "base/memory.h"
#include "mesh/mesh_files.h"
#include "mesh/origin.h"
#include "occlod/base.h"
#include "occlod/mesh.h"

namespace occlod {

class DistinctNames {
 public:
  // Ignores empty names.
  void add(std::string_view name) {
    if (!name.empty() && !names_.contains(name)) names_.emplace(name);
  }
  [[nodiscard]] std::size_t count() const { return names_.size(); }

 private:
  struct Hash : std::hash<std::string_view> {
    using is_transparent = void;
  };
  std::unordered_set<std::string, Hash, std::equal_to<>> names_;
};

// The fields of a soup that do not depend on where its arrays are stored.
struct SoupTables {
  std::vector<Material> materials;
  std::vector<Texture> textures;
  TextureOrigin texture_origin = TextureOrigin::bottom_left;
  glm::dvec3 origin{0.0};  // of positions, see TriangleMesh
  UpAxis up = UpAxis::z;
  std::vector<std::string> feature_names;  // as of a TriangleMesh
  std::uint64_t added_vertices = 0;        // vertices at the end that repeat others with other attributes
  LeftOut left_out;
};

// Where a soup's arrays are stored. InScratch uses scratch files while a MemoryLimit lives.
struct InMemory {
  template <class T>
  using Array = std::vector<T>;
};
struct InScratch {
  template <class T>
  using Array = LargeVector<T>;
};

template <class Storage>
class BasicPolygonSoup : public SoupTables {
 public:
  template <class T>
  using Array = typename Storage::template Array<T>;

  Array<glm::vec3> positions;
  Array<glm::vec3> normals;              // empty or one per vertex, of any length
  Array<glm::u8vec4> colors;             // empty or one per vertex
  Array<glm::vec2> texture_coordinates;  // empty or one per vertex
  Array<MaterialId> polygon_materials;   // empty or one per polygon
  Array<FeatureId> polygon_features;     // empty or one per polygon

  // Adds a vertex. `line` is 0 in binary files.
  void add_vertex(double x, double y, double z, std::uint64_t line);
  // Adds a corner to the current polygon, which end_polygon() ends.
  void add_corner(VertexId vertex) { corners_.push_back(vertex); }
  void end_polygon(std::uint64_t line);
  // Adds a whole polygon of a binary file, which has no line numbers.
  void add_triangle(const Triangle& triangle) {
    if (polygon_ends_.empty())
      triangles_.push_back(triangle);
    else
      add_polygon(triangle);
  }
  [[nodiscard]] std::size_t polygon_count() const { return triangles_.size() + polygon_ends_.size(); }
  // Gives the polygons from `first` on, all that have none, a feature. As long as all have feature 0, none is stored.
  void give_feature(std::size_t first, FeatureId feature) {
    if (feature != 0) polygon_features.resize(first, 0);
    if (!polygon_features.empty()) polygon_features.resize(polygon_count(), feature);
  }
  // Returns the corners of all polygons, one after the other.
  [[nodiscard]] std::span<VertexId> corners();
  // Returns the number of corners of polygon < polygon_count().
  [[nodiscard]] std::size_t corner_count(std::size_t polygon) const { return corners_of(polygon).size(); }
  void reserve_polygons(std::size_t count) { triangles_.reserve(count); }

  // Throws Error when a polygon has fewer than three corners or uses a vertex that does not exist or is not finite, or
  // when there is no polygon. `first_index` is the number of the first vertex in the file. Then makes positions
  // relative to an origin, if the coordinates that polygons use need one.
  void check(const FileErrors& errors, std::uint64_t first_index = 0);

  // Cuts the polygons of a checked soup into triangles. Afterwards the soup has no polygons, but materials and features
  // of triangles.
  [[nodiscard]] Array<Triangle> take_triangles(MeshReport& report, const FileErrors& errors);

 private:
  struct NonfiniteVertex {
    VertexId vertex;
    std::uint64_t line;
  };

  void keep_digits(const glm::dvec3& p, bool is_finite);
  void choose_origin();
  [[nodiscard]] std::string polygon_place(std::size_t polygon) const;
  void check_corners(const FileErrors& errors, std::uint64_t first_index) const;
  void check_finite(const FileErrors& errors) const;
  [[nodiscard]] Array<Triangle> triangulate(MeshReport& report, const FileErrors& errors);
  [[nodiscard]] std::span<const VertexId> corners_of(std::size_t polygon) const;
  [[nodiscard]] bool has_only_valid_triangles() const;
  void add_polygon(const Triangle& triangle);
  void unpack_triangles();

  // Used as long as every polygon is a triangle; then all polygons are unpacked into corners_.
  Array<Triangle> triangles_;
  Array<VertexId> corners_;             // of all polygons, one after the other; the last may be unfinished
  Array<std::size_t> polygon_ends_;     // indices into corners_
  Array<std::uint32_t> polygon_lines_;  // empty for binary files
  std::vector<NonfiniteVertex> nonfinite_;
  // The coordinates of all vertices so far; empty while floats hold them exactly, and once no origin can be needed.
  Array<glm::dvec3> coordinates_;
  OriginChooser near_;  // of vertices so far, to find the latter
  bool may_need_origin_ = true;
};

// Drops the features of a soup whose names say nothing.
template <class Storage>
void drop_unnamed_features(BasicPolygonSoup<Storage>& soup) {
  if (!std::ranges::all_of(soup.feature_names, [](const std::string& name) { return name.empty(); })) return;
  soup.feature_names.clear();
  soup.polygon_features.clear();
}

using PolygonSoup = BasicPolygonSoup<InMemory>;
using ScratchSoup = BasicPolygonSoup<InScratch>;

// Turns a checked soup into a mesh and cuts its polygons into triangles. Leaves the soup empty.
[[nodiscard]] TriangleMesh take_mesh(PolygonSoup& soup, MeshReport& report, const FileErrors& errors);

// The largest number of vertices for which there are ids.
inline constexpr std::uint64_t max_vertices = no_id;

// Rounds to the nearest float; values beyond the range of floats become infinite.
[[nodiscard]] inline float to_float(double value) noexcept {
  static_assert(std::numeric_limits<float>::is_iec559);
  return static_cast<float>(value);
}

// Converts a colour component from [0, 1]; values outside are clamped and NaN becomes 0.
[[nodiscard]] std::uint8_t color_component(double unit_value) noexcept;

// Parses a whole file in any encoding that as_utf8() reads; `input` is at its beginning.
[[nodiscard]] PolygonSoup parse_mesh(MeshFormat format, InputBytes& input, const FileErrors& errors);

// parse_mesh() calls these parsers. Texts are UTF-8, except STL, text or binary, which is as it is in the file.
[[nodiscard]] PolygonSoup parse_off(std::string_view text, const FileErrors& errors);
[[nodiscard]] PolygonSoup parse_gltf(std::string_view bytes, const FileErrors& errors);
[[nodiscard]] PolygonSoup parse_stl(std::string_view bytes, const FileErrors& errors);
// These parsers read a file as it is, in any encoding, block by block. Only UTF-16 is converted as a whole.
template <class Storage>
[[nodiscard]] BasicPolygonSoup<Storage> parse_ply(InputBytes& input, const FileErrors& errors);
template <class Storage>
[[nodiscard]] BasicPolygonSoup<Storage> parse_obj(InputBytes& input, const FileErrors& errors);

// Indices into the values of CornerAttributes. no_id means that the corner has none, which gives (0, 0) or a zero
// normal.
struct AttributeCorner {
  std::uint32_t texture = no_id;
  std::uint32_t normal = no_id;
  [[nodiscard]] bool operator==(const AttributeCorner&) const = default;
};

// Attributes that a file gives to corners of polygons and not to vertices, as OBJ does, and PLY with `texcoord`. They
// belong to a soup with the same Storage.
template <class Storage>
struct CornerAttributes {
  template <class T>
  using Array = typename Storage::template Array<T>;
  Array<AttributeCorner> corners;  // of all polygons, in order; corners missing at the end have no attributes
  Array<glm::vec2> texture_coordinates;
  Array<glm::vec3> normals;
};

// Gives each vertex of a checked soup the attributes of the first corner that uses it; for corners with other
// attributes, vertices are added at the end, which repeat an earlier one. Sets those attribute arrays of the soup for
// which any corner has a value; added vertices copy the other attributes of the vertex that they repeat. Throws Error
// when there are not enough ids for the vertices. Expected O(n).
template <class Storage>
void split_vertices(BasicPolygonSoup<Storage>& soup, const CornerAttributes<Storage>& attributes,
                    const FileErrors& errors);

}  // namespace occlod
