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

void PolygonSoup::check(const FileErrors& errors, std::uint64_t first_index) const {
  if (polygon_ends_.empty()) errors.fail("", "has no faces", "export the mesh with its faces");
  if (positions.size() >= max_vertices) errors.fail("", "has too many vertices", "cut the mesh into parts");
  for (std::size_t polygon = 0; polygon < polygon_ends_.size(); ++polygon) {
    const std::size_t begin = first_corner(polygon);
    const std::size_t end = polygon_ends_[polygon];
    if (end - begin < 3) {
      errors.fail(polygon_place(polygon), fmt::format("a face needs three corners or more, but has {}", end - begin),
                  "remove the face or export the mesh again");
    }
    for (std::size_t i = begin; i < end; ++i) {
      if (corners_[i] < positions.size()) continue;
      errors.fail(polygon_place(polygon),
                  fmt::format("a face uses vertex {}, but there are only {} vertices, numbered from {}",
                              corners_[i] + first_index, positions.size(), first_index),
                  "remove the face or export the mesh again");
    }
  }
  check_finite(errors);
}

void PolygonSoup::check_finite(const FileErrors& errors) const {
  if (nonfinite_.empty()) return;
  std::vector<bool> used(positions.size());
  for (const VertexId corner : corners_) used[corner] = true;
  for (const auto& [vertex, line] : nonfinite_) {
    if (!used[vertex]) continue;
    errors.fail(line != 0 ? fmt::format("line {}", line) : fmt::format("vertex {}, numbered from 0", vertex),
                "a coordinate of a vertex is NaN, infinite or too large",
                "remove the vertex and its faces, or export the mesh again");
  }
}

TriangleMesh PolygonSoup::take_mesh(MeshReport& report, const FileErrors& errors) {
  report.vertices_read = positions.size();
  report.polygons_read = polygon_ends_.size();
  report.attribute_conflicts = attribute_conflicts;
  TriangleMesh mesh;
  mesh.triangles.reserve(corners_.size() - 2 * polygon_ends_.size());
  Triangulator triangulator(positions);
  for (std::size_t polygon = 0; polygon < polygon_ends_.size(); ++polygon) {
    const std::size_t begin = first_corner(polygon);
    const std::span<const VertexId> corners(corners_.data() + begin, polygon_ends_[polygon] - begin);
    if (corners.size() > 3) ++report.polygons_triangulated;
    if (triangulator.append(corners, mesh.triangles)) continue;
    errors.fail(polygon_place(polygon),
                fmt::format("a face with {} corners is too large to triangulate", corners.size()),
                "triangulate the mesh before exporting it");
  }
  report.triangles_read = mesh.triangle_count();
  mesh.positions = std::move(positions);
  mesh.normals = std::move(normals);
  mesh.colors = std::move(colors);
  *this = {};
  return mesh;
}

}  // namespace occlod
