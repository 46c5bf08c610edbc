#include "splits/attribute_state.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

namespace occlod {
namespace {

// As long as twice the area.
glm::dvec3 normal_of(const TriangleMesh& mesh, const Triangle& t) {
  const glm::dvec3 a(mesh.positions[t.x]);
  return glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a);
}

// Of the squared edges, in texture space: faces of less area there have a line of the texture, but for rounding, and
// their area says nothing.
constexpr double least_area = 1e-4;

// sqrt(area / area in texture space), of the faces at each wedge. Where texture space has no area, that of the mesh.
std::vector<float> lengths_of_texture(const TriangleMesh& mesh, float scale) {
  if (mesh.texture_coordinates.empty()) return {};
  struct Areas {
    double surface = 0.0, texture = 0.0, edges2 = 0.0;
    void add(const Areas& o) { surface += o.surface, texture += o.texture, edges2 += o.edges2; }
    [[nodiscard]] bool usable() const { return surface > 0.0 && texture > least_area * edges2; }
    [[nodiscard]] float length() const { return static_cast<float>(std::sqrt(surface / texture)); }
  };
  std::vector<Areas> at(mesh.wedge_count());
  Areas all;
  for (const Triangle& t : mesh.wedge_triangles()) {
    const glm::dvec2 o(mesh.texture_coordinates[t.x]);
    const glm::dvec2 p = glm::dvec2(mesh.texture_coordinates[t.y]) - o,
                     q = glm::dvec2(mesh.texture_coordinates[t.z]) - o;
    const Areas areas{glm::length(normal_of(mesh, t)) * scale * scale, std::abs(p.x * q.y - p.y * q.x),
                      glm::dot(p, p) + glm::dot(q, q)};
    for (int i = 0; i < 3; ++i) at[t[i]].add(areas);
    all.add(areas);
  }
  const float usual = all.usable() ? all.length() : 0.0F;
  std::vector<float> lengths(at.size());
  for (std::size_t w = 0; w < at.size(); ++w) lengths[w] = at[w].usable() ? at[w].length() : usual;
  return lengths;
}

// Faces that share wedges are one chart. About its mean square width, by wedge.
std::vector<float> chart_extents2(const TriangleMesh& mesh, float scale) {
  std::vector<WedgeId> chart(mesh.wedge_count());
  std::iota(chart.begin(), chart.end(), WedgeId{0});
  const auto root = [&](WedgeId w) {
    while (chart[w] != w) w = chart[w] = chart[chart[w]];
    return w;
  };
  for (const Triangle& t : mesh.wedge_triangles()) {
    chart[root(t.y)] = root(t.x);
    chart[root(t.z)] = root(t.x);
  }
  std::vector<double> sums(chart.size(), 0.0);
  for (const Triangle& t : mesh.wedge_triangles())
    sums[root(t.x)] += 0.5 * glm::length(normal_of(mesh, t)) * scale * scale;
  std::vector<float> extents2(chart.size());
  for (WedgeId w = 0; w < chart.size(); ++w) extents2[w] = static_cast<float>(sums[root(w)] / 6.0);
  return extents2;
}

}  // namespace

std::vector<MaterialId> wedge_materials(const TriangleMesh& mesh) {
  if (mesh.triangle_materials.empty()) return {};
  std::vector<MaterialId> materials(mesh.wedge_count(), 0);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (int i = 0; i < 3; ++i) materials[mesh.wedge_triangles()[t][i]] = mesh.triangle_materials[t];
  return materials;
}

AttributeState::AttributeState(const TriangleMesh& mesh, float scale)
    : input(mesh),
      materials(wedge_materials(mesh)),
      texture_lengths(lengths_of_texture(mesh, scale)),
      extents2(chart_extents2(mesh, scale)),
      corners(mesh, materials),
      sums(mesh.vertex_count(), 0.0F) {}

}  // namespace occlod
