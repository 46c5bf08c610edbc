#include "mesh/polygon_soup.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>
#include <utility>

#include "base/arithmetic.h"
#include "base/memory.h"
#include "mesh/triangulate.h"

namespace occlod {
namespace {

constexpr std::size_t polygons_between_looks = 4096;  // between two calls of make_room()

}  // namespace

std::uint8_t color_component(double unit_value) noexcept {
  if (!(unit_value > 0.0)) return 0;
  return static_cast<std::uint8_t>(std::lround(std::min(unit_value, 1.0) * 255.0));
}

template <class Storage>
void BasicPolygonSoup<Storage>::add_vertex(double x, double y, double z, std::uint64_t line) {
  const glm::vec3 p(to_float(x), to_float(y), to_float(z));
  const bool is_finite = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  if (!is_finite) nonfinite_.push_back({static_cast<VertexId>(positions.size()), line});
  if (may_need_origin_) {
    const glm::dvec3 exact(x, y, z);
    if (!coordinates_.empty() || (is_finite && glm::dvec3(p) != exact)) keep_digits(exact, is_finite);
  }
  positions.push_back(p);
}

template <class Storage>
void BasicPolygonSoup<Storage>::keep_digits(const glm::dvec3& p, bool is_finite) {
  // Many files have a vertex at 0 that no polygon uses, which says nothing about where the mesh is.
  const auto look_at = [&](const glm::dvec3& at) {
    if (at != glm::dvec3(0.0)) near_.add(at);
  };
  if (coordinates_.empty()) {
    coordinates_.reserve(positions.capacity());
    for (const glm::vec3& before : positions) {
      if (coordinates_.size() % polygons_between_looks == 0) make_room();
      coordinates_.emplace_back(before);
      if (std::isfinite(before.x) && std::isfinite(before.y) && std::isfinite(before.z)) look_at(coordinates_.back());
    }
  }
  coordinates_.push_back(p);
  if (is_finite) look_at(p);
  may_need_origin_ = !near_.is_settled();
  if (!may_need_origin_) coordinates_ = {};
}

template <class Storage>
void BasicPolygonSoup<Storage>::choose_origin() {
  if (coordinates_.empty()) return;
  OriginChooser used;
  for (std::size_t polygon = 0; polygon < polygon_count(); ++polygon) {
    if (polygon % polygons_between_looks == 0) make_room();
    for (const VertexId corner : corners_of(polygon)) used.add(coordinates_[corner]);
  }
  const Origin chosen = used.choose();
  for (std::size_t v = 0; chosen.step > 0.0 && v < positions.size(); ++v) {
    if (v % polygons_between_looks == 0) make_room();
    positions[v] = chosen.position_of(coordinates_[v]);
  }
  origin = chosen.at;
  coordinates_ = {};
}

template <class Storage>
std::string BasicPolygonSoup<Storage>::polygon_place(std::size_t polygon) const {
  if (!polygon_lines_.empty()) return fmt::format("line {}", polygon_lines_[polygon]);
  return fmt::format("face {}, numbered from 0", polygon);
}

template <class Storage>
void BasicPolygonSoup<Storage>::end_polygon(std::uint64_t line) {
  if (line != 0) polygon_lines_.push_back(static_cast<std::uint32_t>(line));
  if (polygon_ends_.empty() && corners_.size() == 3) {
    triangles_.emplace_back(corners_[0], corners_[1], corners_[2]);
    corners_.clear();
    return;
  }
  if (!triangles_.empty()) unpack_triangles();
  polygon_ends_.push_back(corners_.size());
}

template <class Storage>
void BasicPolygonSoup<Storage>::add_polygon(const Triangle& triangle) {
  for (int corner = 0; corner < 3; ++corner) add_corner(triangle[corner]);
  end_polygon(0);
}

// On entry corners_ holds the first polygon that is not a triangle.
template <class Storage>
void BasicPolygonSoup<Storage>::unpack_triangles() {
  const Array<VertexId> last = std::move(corners_);
  corners_.clear();
  corners_.reserve(3 * triangles_.size() + last.size());
  for (const Triangle& t : triangles_) {
    if (polygon_ends_.size() % polygons_between_looks == 0) make_room();
    corners_.insert(corners_.end(), {t.x, t.y, t.z});
    polygon_ends_.push_back(corners_.size());
  }
  corners_.insert(corners_.end(), last.begin(), last.end());
  triangles_ = {};
}

template <class Storage>
std::span<const VertexId> BasicPolygonSoup<Storage>::corners_of(std::size_t polygon) const {
  if (!triangles_.empty()) return {&triangles_[polygon].x, 3};
  const std::size_t begin = polygon == 0 ? 0 : polygon_ends_[polygon - 1];
  return {corners_.data() + begin, polygon_ends_[polygon] - begin};
}

template <class Storage>
std::span<VertexId> BasicPolygonSoup<Storage>::corners() {
  static_assert(sizeof(Triangle) == 3 * sizeof(VertexId));
  if (!triangles_.empty()) return {&triangles_[0].x, 3 * triangles_.size()};
  return corners_;
}

template <class Storage>
bool BasicPolygonSoup<Storage>::has_only_valid_triangles() const {
  if (triangles_.empty()) return false;
  VertexId largest = 0;
  for (std::size_t begin = 0; begin < triangles_.size(); begin += polygons_between_looks) {
    make_room();
    const std::size_t count = std::min(polygons_between_looks, triangles_.size() - begin);
    for (const Triangle& t : std::span(triangles_).subspan(begin, count)) largest = std::max({largest, t.x, t.y, t.z});
  }
  return largest < positions.size();
}

template <class Storage>
void BasicPolygonSoup<Storage>::check(const FileErrors& errors, std::uint64_t first_index) {
  if (polygon_count() == 0) errors.fail("", "has no faces", "export the mesh with its faces");
  if (positions.size() >= max_vertices) errors.fail("", "has too many vertices", "split the mesh into parts");
  check_corners(errors, first_index);
  check_finite(errors);
  choose_origin();
}

template <class Storage>
void BasicPolygonSoup<Storage>::check_corners(const FileErrors& errors, std::uint64_t first_index) const {
  if (has_only_valid_triangles()) return;
  for (std::size_t polygon = 0; polygon < polygon_count(); ++polygon) {
    if (polygon % polygons_between_looks == 0) make_room();
    const std::span<const VertexId> corners = corners_of(polygon);
    if (corners.size() < 3) {
      errors.fail(polygon_place(polygon), fmt::format("a face needs three corners or more, but has {}", corners.size()),
                  "remove the face or export the mesh again");
    }
    for (const VertexId corner : corners) {
      if (corner < positions.size()) continue;
      errors.fail(polygon_place(polygon),
                  fmt::format("a face uses vertex {}, but there are only {} vertices, numbered from {}",
                              corner + first_index, positions.size(), first_index),
                  "remove the face or export the mesh again");
    }
  }
}

template <class Storage>
void BasicPolygonSoup<Storage>::check_finite(const FileErrors& errors) const {
  if (nonfinite_.empty()) return;
  std::vector<bool> used(positions.size());
  for (std::size_t polygon = 0; polygon < polygon_count(); ++polygon) {
    if (polygon % polygons_between_looks == 0) make_room();
    for (const VertexId corner : corners_of(polygon)) used[corner] = true;
  }
  for (const auto& [vertex, line] : nonfinite_) {
    if (!used[vertex]) continue;
    errors.fail(line != 0 ? fmt::format("line {}", line) : fmt::format("vertex {}, numbered from 0", vertex),
                "a coordinate of a vertex is NaN, infinite or too large",
                "remove the vertex and its faces, or export the mesh again");
  }
}

template <class Storage>
auto BasicPolygonSoup<Storage>::take_triangles(MeshReport& report, const FileErrors& errors) -> Array<Triangle> {
  report.vertices_read = positions.size() - added_vertices;
  report.polygons_read = polygon_count();
  report.left_out = left_out;
  Array<Triangle> triangles = triangles_.empty() ? triangulate(report, errors) : std::move(triangles_);
  report.triangles_read = triangles.size();
  triangles_ = {};
  return triangles;
}

template <class Storage>
auto BasicPolygonSoup<Storage>::triangulate(MeshReport& report, const FileErrors& errors) -> Array<Triangle> {
  Array<Triangle> triangles;
  Array<MaterialId> materials_of_triangles;
  Array<FeatureId> features_of_triangles;
  triangles.reserve(corners_.size() - 2 * polygon_ends_.size());
  if (!polygon_materials.empty()) materials_of_triangles.reserve(triangles.capacity());
  if (!polygon_features.empty()) features_of_triangles.reserve(triangles.capacity());
  Triangulator triangulator(positions);
  for (std::size_t polygon = 0; polygon < polygon_ends_.size(); ++polygon) {
    if (polygon % polygons_between_looks == 0) make_room();
    const std::span<const VertexId> corners = corners_of(polygon);
    if (corners.size() > 3) ++report.polygons_triangulated;
    if (!triangulator.append(corners, triangles)) {
      errors.fail(polygon_place(polygon),
                  fmt::format("a face with {} corners is too large to triangulate", corners.size()),
                  "triangulate the mesh before exporting it");
    }
    if (!polygon_materials.empty()) materials_of_triangles.resize(triangles.size(), polygon_materials[polygon]);
    if (!polygon_features.empty()) features_of_triangles.resize(triangles.size(), polygon_features[polygon]);
  }
  polygon_materials = std::move(materials_of_triangles);
  polygon_features = std::move(features_of_triangles);
  corners_ = {};
  polygon_ends_ = {};
  return triangles;
}

TriangleMesh take_mesh(PolygonSoup& soup, MeshReport& report, const FileErrors& errors) {
  TriangleMesh mesh;
  mesh.triangles = soup.take_triangles(report, errors);
  mesh.triangle_materials = std::move(soup.polygon_materials);
  mesh.triangle_features = std::move(soup.polygon_features);
  mesh.feature_names = std::move(soup.feature_names);
  mesh.positions = std::move(soup.positions);
  mesh.normals = std::move(soup.normals);
  mesh.colors = std::move(soup.colors);
  mesh.texture_coordinates = std::move(soup.texture_coordinates);
  mesh.materials = std::move(soup.materials);
  mesh.textures = std::move(soup.textures);
  mesh.texture_origin = soup.texture_origin;
  mesh.origin = soup.origin;
  mesh.up = soup.up;
  soup = {};
  return mesh;
}

template class BasicPolygonSoup<InMemory>;
template class BasicPolygonSoup<InScratch>;

namespace {

using Corner = AttributeCorner;

constexpr std::size_t corners_between_looks = 4096;  // between two calls of make_room()

template <class Storage>
class VertexSplitter {
 public:
  VertexSplitter(BasicPolygonSoup<Storage>& soup, const CornerAttributes<Storage>& attributes)
      : soup_(soup),
        values_(attributes),
        vertices_(soup.positions.size()),
        first_(vertices_),
        is_used_(vertices_),
        slots_(64, no_id) {}

  // Returns false when there are more vertices than ids.
  [[nodiscard]] bool run() {
    const std::span<VertexId> ids = soup_.corners();
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (i % corners_between_looks == 0) make_room();
      const Corner corner = i < values_.corners.size() ? values_.corners[i] : Corner{};
      has_texture_ |= corner.texture != no_id;
      has_normal_ |= corner.normal != no_id;
      ids[i] = vertex_for(ids[i], corner);
      if (vertices_ + added_.size() >= max_vertices) return false;
    }
    append_vertices();
    return true;
  }

 private:
  template <class T>
  using Array = typename Storage::template Array<T>;

  struct Added {
    VertexId vertex;  // the vertex that it repeats
    Corner corner;
  };

  VertexId vertex_for(VertexId vertex, const Corner& corner) {
    if (!is_used_[vertex]) {
      is_used_[vertex] = true;
      first_[vertex] = corner;
      return vertex;
    }
    if (is_same(first_[vertex], corner)) return vertex;
    if (2 * added_.size() >= slots_.size()) grow();
    std::size_t slot = hash_of({vertex, corner}) & (slots_.size() - 1);
    while (slots_[slot] != no_id && !is_same(added_[slots_[slot]], {vertex, corner}))
      slot = (slot + 1) & (slots_.size() - 1);
    if (slots_[slot] == no_id) {
      slots_[slot] = static_cast<std::uint32_t>(added_.size());
      added_.push_back({vertex, corner});
    }
    return static_cast<VertexId>(vertices_ + slots_[slot]);
  }

  [[nodiscard]] glm::vec2 texture_of(const Corner& corner) const {
    return corner.texture == no_id ? glm::vec2(0.0F) : values_.texture_coordinates[corner.texture];
  }
  [[nodiscard]] glm::vec3 normal_of(const Corner& corner) const {
    return corner.normal == no_id ? glm::vec3(0.0F) : values_.normals[corner.normal];
  }
  static std::uint64_t bits(float a, float b) {
    return std::bit_cast<std::uint32_t>(a) | std::uint64_t{std::bit_cast<std::uint32_t>(b)} << 32;
  }

  // Compares values bit by bit: many files have equal values under several indices, and some have NaN.
  [[nodiscard]] bool is_same(const Corner& a, const Corner& b) const {
    if (a == b) return true;
    const glm::vec2 s = texture_of(a), t = texture_of(b);
    const glm::vec3 m = normal_of(a), n = normal_of(b);
    return bits(s.x, s.y) == bits(t.x, t.y) && bits(m.x, m.y) == bits(n.x, n.y) && bits(m.z, 0) == bits(n.z, 0);
  }
  [[nodiscard]] bool is_same(const Added& a, const Added& b) const {
    return a.vertex == b.vertex && is_same(a.corner, b.corner);
  }
  [[nodiscard]] std::size_t hash_of(const Added& of) const {
    const glm::vec2 t = texture_of(of.corner);
    const glm::vec3 n = normal_of(of.corner);
    return scatter(scatter(scatter(of.vertex + bits(t.x, t.y)) + bits(n.x, n.y)) + bits(n.z, 0));
  }

  void grow() {
    slots_.assign(2 * slots_.size(), no_id);
    for (std::uint32_t i = 0; i < added_.size(); ++i) {
      std::size_t slot = hash_of(added_[i]) & (slots_.size() - 1);
      while (slots_[slot] != no_id) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = i;
    }
  }

  void append_vertices() {
    repeat(soup_.positions);
    repeat(soup_.normals);
    repeat(soup_.colors);
    soup_.added_vertices += added_.size();
    if (has_texture_) take(soup_.texture_coordinates, [this](const Corner& corner) { return texture_of(corner); });
    if (has_normal_) take(soup_.normals, [this](const Corner& corner) { return normal_of(corner); });
  }

  template <class T>
  void repeat(Array<T>& values) const {
    if (values.empty()) return;
    values.reserve(vertices_ + added_.size());
    for (const Added& added : added_) values.push_back(values[added.vertex]);
  }

  template <class T, class ValueOf>
  void take(Array<T>& values, ValueOf value_of) const {
    values.clear();
    values.reserve(vertices_ + added_.size());
    for (const Corner& corner : first_) values.push_back(value_of(corner));
    for (const Added& added : added_) values.push_back(value_of(added.corner));
  }

  BasicPolygonSoup<Storage>& soup_;
  const CornerAttributes<Storage>& values_;
  std::size_t vertices_;   // number of vertices before any was added
  Array<Corner> first_;    // by vertex
  Array<bool> is_used_;    // by vertex
  Array<Added> added_;     // vertices with ids from vertices_ on
  Array<VertexId> slots_;  // indices into added_: open addressing, at most half full
  bool has_texture_ = false;
  bool has_normal_ = false;
};

}  // namespace

template <class Storage>
void split_vertices(BasicPolygonSoup<Storage>& soup, const CornerAttributes<Storage>& attributes,
                    const FileErrors& errors) {
  if (!VertexSplitter<Storage>(soup, attributes).run())
    errors.fail("", "has too many vertices with attributes of their own", "split the mesh into parts");
}

template void split_vertices(PolygonSoup&, const CornerAttributes<InMemory>&, const FileErrors&);
template void split_vertices(ScratchSoup&, const CornerAttributes<InScratch>&, const FileErrors&);

}  // namespace occlod
