#include "occlod/mesh/merge_wedges.h"

#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <vector>

namespace occlod {
namespace {

// Calls merge(vertex, first, last) for each vertex with more than one wedge: of the others, those in [first, last) of
// extra_wedges.
template <class Merge>
void for_each_seam_vertex(const TriangleMesh& mesh, Merge merge) {
  const std::vector<VertexId>& extra = mesh.extra_wedges;
  for (std::size_t first = 0, last = 0; first < extra.size(); first = last) {
    while (last < extra.size() && extra[last] == extra[first]) ++last;
    merge(extra[first], first, last);
  }
}

void merge_normals(const TriangleMesh& mesh, std::vector<glm::vec3>& normals) {
  const std::size_t vertices = mesh.vertex_count();
  for_each_seam_vertex(mesh, [&](VertexId v, std::size_t first, std::size_t last) {
    glm::dvec3 sum(normals[v]);
    for (std::size_t i = first; i < last; ++i) sum += glm::dvec3(mesh.normals[vertices + i]);
    const double length = glm::length(sum);
    if (length > 0.0) normals[v] = glm::vec3(sum / length);
  });
}

void merge_colors(const TriangleMesh& mesh, std::vector<glm::u8vec4>& colors) {
  const std::size_t vertices = mesh.vertex_count();
  for_each_seam_vertex(mesh, [&](VertexId v, std::size_t first, std::size_t last) {
    glm::u64vec4 sum(colors[v]);
    for (std::size_t i = first; i < last; ++i) sum += glm::u64vec4(mesh.colors[vertices + i]);
    const std::uint64_t count = 1 + last - first;
    colors[v] = glm::u8vec4((sum + count / 2) / count);
  });
}

template <class T>
std::vector<T> first_ones(const std::vector<T>& values, std::size_t count) {
  return values.empty() ? values : std::vector<T>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace

TriangleMesh merge_wedges(const TriangleMesh& mesh) {
  TriangleMesh merged;
  merged.positions = first_ones(mesh.positions, mesh.vertex_count());
  merged.normals = first_ones(mesh.normals, mesh.vertex_count());
  merged.colors = first_ones(mesh.colors, mesh.vertex_count());
  merged.triangles = mesh.triangles;
  if (!mesh.normals.empty()) merge_normals(mesh, merged.normals);
  if (!mesh.colors.empty()) merge_colors(mesh, merged.colors);
  return merged;
}

}  // namespace occlod
