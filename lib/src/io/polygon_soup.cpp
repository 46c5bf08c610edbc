#include "io/polygon_soup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "io/triangulate.h"

namespace occlod {

std::uint8_t color_component(double unit_value) noexcept {
  if (!(unit_value > 0.0)) return 0;
  return static_cast<std::uint8_t>(std::lround(std::min(unit_value, 1.0) * 255.0));
}

void PolygonSoup::add_vertex(double x, double y, double z, std::uint64_t line) {
  const glm::vec3 p(to_float(x), to_float(y), to_float(z));
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
    nonfinite_.push_back({static_cast<VertexId>(positions.size()), line});
  }
  positions.push_back(p);
}

std::string PolygonSoup::polygon_place(std::size_t polygon) const {
  if (!polygon_lines_.empty()) return fmt::format("line {}", polygon_lines_[polygon]);
  return fmt::format("face {}, numbered from 0", polygon);
}

void PolygonSoup::end_polygon(std::uint64_t line) {
  if (line != 0) polygon_lines_.push_back(static_cast<std::uint32_t>(line));
  if (polygon_ends_.empty() && corners_.size() == 3) {
    triangles_.emplace_back(corners_[0], corners_[1], corners_[2]);
    corners_.clear();
    return;
  }
  if (!triangles_.empty()) unpack_triangles();
  polygon_ends_.push_back(corners_.size());
}

void PolygonSoup::add_polygon(const Triangle& triangle) {
  for (int corner = 0; corner < 3; ++corner) add_corner(triangle[corner]);
  end_polygon(0);
}

// corners_ holds the first polygon that is not a triangle.
void PolygonSoup::unpack_triangles() {
  const std::vector<VertexId> last = std::move(corners_);
  corners_.clear();
  corners_.reserve(3 * triangles_.size() + last.size());
  for (const Triangle& t : triangles_) {
    corners_.insert(corners_.end(), {t.x, t.y, t.z});
    polygon_ends_.push_back(corners_.size());
  }
  corners_.insert(corners_.end(), last.begin(), last.end());
  triangles_ = {};
}

std::span<const VertexId> PolygonSoup::corners_of(std::size_t polygon) const {
  if (!triangles_.empty()) return {&triangles_[polygon].x, 3};
  const std::size_t begin = polygon == 0 ? 0 : polygon_ends_[polygon - 1];
  return {corners_.data() + begin, polygon_ends_[polygon] - begin};
}

std::span<VertexId> PolygonSoup::corners() {
  static_assert(sizeof(Triangle) == 3 * sizeof(VertexId));
  if (!triangles_.empty()) return {&triangles_[0].x, 3 * triangles_.size()};
  return corners_;
}

bool PolygonSoup::has_only_valid_triangles() const {
  if (triangles_.empty()) return false;
  VertexId largest = 0;
  for (const Triangle& t : triangles_) largest = std::max({largest, t.x, t.y, t.z});
  return largest < positions.size();
}

void PolygonSoup::check(const FileErrors& errors, std::uint64_t first_index) const {
  if (polygon_count() == 0) errors.fail("", "has no faces", "export the mesh with its faces");
  if (positions.size() >= max_vertices) errors.fail("", "has too many vertices", "split the mesh into parts");
  check_corners(errors, first_index);
  check_finite(errors);
}

void PolygonSoup::check_corners(const FileErrors& errors, std::uint64_t first_index) const {
  if (has_only_valid_triangles()) return;
  for (std::size_t polygon = 0; polygon < polygon_count(); ++polygon) {
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

void PolygonSoup::check_finite(const FileErrors& errors) const {
  if (nonfinite_.empty()) return;
  std::vector<bool> used(positions.size());
  for (std::size_t polygon = 0; polygon < polygon_count(); ++polygon) {
    for (const VertexId corner : corners_of(polygon)) used[corner] = true;
  }
  for (const auto& [vertex, line] : nonfinite_) {
    if (!used[vertex]) continue;
    errors.fail(line != 0 ? fmt::format("line {}", line) : fmt::format("vertex {}, numbered from 0", vertex),
                "a coordinate of a vertex is NaN, infinite or too large",
                "remove the vertex and its faces, or export the mesh again");
  }
}

TriangleMesh PolygonSoup::take_mesh(MeshReport& report, const FileErrors& errors) {
  report.vertices_read = positions.size() - added_vertices;
  report.polygons_read = polygon_count();
  report.left_out = left_out;
  TriangleMesh mesh;
  if (triangles_.empty()) {
    triangulate(mesh, report, errors);
  } else {
    mesh.triangles = std::move(triangles_);
    mesh.triangle_materials = std::move(polygon_materials);
  }
  report.triangles_read = mesh.triangle_count();
  mesh.positions = std::move(positions);
  mesh.normals = std::move(normals);
  mesh.colors = std::move(colors);
  mesh.texture_coordinates = std::move(texture_coordinates);
  mesh.materials = std::move(materials);
  mesh.textures = std::move(textures);
  mesh.texture_origin = texture_origin;
  *this = {};
  return mesh;
}

void PolygonSoup::triangulate(TriangleMesh& mesh, MeshReport& report, const FileErrors& errors) const {
  mesh.triangles.reserve(corners_.size() - 2 * polygon_ends_.size());
  if (!polygon_materials.empty()) mesh.triangle_materials.reserve(mesh.triangles.capacity());
  Triangulator triangulator(positions);
  for (std::size_t polygon = 0; polygon < polygon_ends_.size(); ++polygon) {
    const std::span<const VertexId> corners = corners_of(polygon);
    if (corners.size() > 3) ++report.polygons_triangulated;
    if (!triangulator.append(corners, mesh.triangles)) {
      errors.fail(polygon_place(polygon),
                  fmt::format("a face with {} corners is too large to triangulate", corners.size()),
                  "triangulate the mesh before exporting it");
    }
    if (!polygon_materials.empty()) mesh.triangle_materials.resize(mesh.triangles.size(), polygon_materials[polygon]);
  }
}

}  // namespace occlod
