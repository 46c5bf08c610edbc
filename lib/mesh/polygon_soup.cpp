#include "mesh/polygon_soup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/scratch_memory.h"
#include "mesh/triangulate.h"

namespace occlod {
namespace {

constexpr std::size_t polygons_between_looks = 4096;  // whether memory has room

}  // namespace

std::uint8_t color_component(double unit_value) noexcept {
  if (!(unit_value > 0.0)) return 0;
  return static_cast<std::uint8_t>(std::lround(std::min(unit_value, 1.0) * 255.0));
}

template <class Storage>
void BasicPolygonSoup<Storage>::add_vertex(double x, double y, double z, std::uint64_t line) {
  const glm::vec3 p(to_float(x), to_float(y), to_float(z));
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
    nonfinite_.push_back({static_cast<VertexId>(positions.size()), line});
  }
  positions.push_back(p);
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

// corners_ holds the first polygon that is not a triangle.
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
void BasicPolygonSoup<Storage>::check(const FileErrors& errors, std::uint64_t first_index) const {
  if (polygon_count() == 0) errors.fail("", "has no faces", "export the mesh with its faces");
  if (positions.size() >= max_vertices) errors.fail("", "has too many vertices", "split the mesh into parts");
  check_corners(errors, first_index);
  check_finite(errors);
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
  triangles.reserve(corners_.size() - 2 * polygon_ends_.size());
  if (!polygon_materials.empty()) materials_of_triangles.reserve(triangles.capacity());
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
  }
  polygon_materials = std::move(materials_of_triangles);
  corners_ = {};
  polygon_ends_ = {};
  return triangles;
}

TriangleMesh take_mesh(PolygonSoup& soup, MeshReport& report, const FileErrors& errors) {
  TriangleMesh mesh;
  mesh.triangles = soup.take_triangles(report, errors);
  mesh.triangle_materials = std::move(soup.polygon_materials);
  mesh.positions = std::move(soup.positions);
  mesh.normals = std::move(soup.normals);
  mesh.colors = std::move(soup.colors);
  mesh.texture_coordinates = std::move(soup.texture_coordinates);
  mesh.materials = std::move(soup.materials);
  mesh.textures = std::move(soup.textures);
  mesh.texture_origin = soup.texture_origin;
  soup = {};
  return mesh;
}

template class BasicPolygonSoup<InMemory>;
template class BasicPolygonSoup<InScratch>;

}  // namespace occlod
