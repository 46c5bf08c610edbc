// What holds for the wedges of every clean mesh, and what a mesh looks like at its corners.
#pragma once

#include <cstring>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::test {

// Everything that is drawn at a corner of a triangle, as bits.
struct Corner {
  glm::vec3 position{0.0F};
  glm::vec3 normal{0.0F};
  glm::u8vec4 color{0};
  glm::vec2 texture_coordinate{0.0F};
  MaterialId material = 0;

  [[nodiscard]] bool operator==(const Corner& other) const { return key() == other.key(); }
  [[nodiscard]] bool operator<(const Corner& other) const { return key() < other.key(); }
  [[nodiscard]] std::vector<std::uint32_t> key() const {
    std::vector<std::uint32_t> bits;
    const auto add = [&](const void* from, std::size_t bytes) {
      bits.resize(bits.size() + bytes / 4);
      std::memcpy(bits.data() + bits.size() - bytes / 4, from, bytes);
    };
    add(&position, sizeof position);
    add(&normal, sizeof normal);
    add(&color, sizeof color);
    add(&texture_coordinate, sizeof texture_coordinate);
    bits.push_back(material);
    return bits;
  }
};

// Three for each triangle, in order.
[[nodiscard]] inline std::vector<Corner> corners_of(const TriangleMesh& mesh) {
  std::vector<Corner> corners;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const WedgeId w = mesh.wedge_triangles()[t][k];
      Corner corner;
      corner.position = mesh.positions[w];
      if (!mesh.normals.empty()) corner.normal = mesh.normals[w];
      if (!mesh.colors.empty()) corner.color = mesh.colors[w];
      if (!mesh.texture_coordinates.empty()) corner.texture_coordinate = mesh.texture_coordinates[w];
      corner.material = mesh.material_of(t);
      corners.push_back(corner);
    }
  }
  return corners;
}

// What is wrong with the wedges of a clean mesh; empty where all is well.
[[nodiscard]] inline std::string wedge_problem(const TriangleMesh& mesh) {
  const auto has_size = [&](std::size_t size) { return size == 0 || size == mesh.wedge_count(); };
  if (!has_size(mesh.normals.size()) || !has_size(mesh.colors.size()) || !has_size(mesh.texture_coordinates.size()))
    return "an array has another size than there are wedges";
  if (mesh.corners.size() != (mesh.extra_wedges.empty() ? 0 : mesh.triangle_count()))
    return "corners have a wrong size";
  if (!mesh.triangle_materials.empty() && mesh.triangle_materials.size() != mesh.triangle_count())
    return "triangle_materials have a wrong size";
  for (std::size_t i = 0; i < mesh.extra_wedges.size(); ++i) {
    const VertexId v = mesh.extra_wedges[i];
    if (v >= mesh.vertex_count() || (i > 0 && v < mesh.extra_wedges[i - 1])) return "extra wedges do not ascend";
    const WedgeId w = static_cast<WedgeId>(mesh.vertex_count() + i);
    if (std::memcmp(&mesh.positions[w], &mesh.positions[v], sizeof(glm::vec3)) != 0)
      return "a wedge has another place than its vertex";
  }
  std::vector<Corner> of_wedge(mesh.wedge_count());
  std::vector<bool> used(mesh.wedge_count());
  const std::vector<Corner> corners = corners_of(mesh);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const WedgeId w = mesh.wedge_triangles()[i / 3][static_cast<int>(i % 3)];
    if (w >= mesh.wedge_count() || mesh.vertex_of(w) != mesh.triangles[i / 3][static_cast<int>(i % 3)])
      return "a corner has the wedge of another vertex";
    if (used[w] && of_wedge[w].material != corners[i].material) return "a wedge has two materials";
    used[w] = true;
    of_wedge[w] = corners[i];
  }
  std::map<std::pair<VertexId, std::vector<std::uint32_t>>, WedgeId> wedges;
  for (WedgeId w = 0; w < mesh.wedge_count(); ++w) {
    if (!used[w]) return "a wedge is not used";
    if (!wedges.emplace(std::pair(mesh.vertex_of(w), of_wedge[w].key()), w).second) return "two wedges are the same";
  }
  return {};
}

}  // namespace occlod::test
