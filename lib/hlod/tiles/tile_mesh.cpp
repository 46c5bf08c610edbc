#include "hlod/tiles/tile_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "occlod/mesh/clean.h"
#include "occlod/mesh/crease.h"

namespace occlod::tiles {
namespace {

bool has_area(const TriangleMesh& mesh, const Triangle& t) {
  const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
  return a != b && b != c && c != a;
}

void take_materials(TriangleMesh& mesh, const hlod::NodeMesh& node) {
  if (node.materials.empty()) return;
  for (const Triangle& t : mesh.triangles) mesh.triangle_materials.push_back(node.materials[t.x]);
}

// Smooth across the border too where the node's own normal is within the angle of what all nodes there have.
void take_border_normals(TriangleMesh& mesh, double crease_deg, const BorderVertices& borders) {
  const float least_cosine = static_cast<float>(std::cos(crease_deg * 0.017453292519943295));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const BorderVertex* border = borders.at(mesh.positions[v]);
    if (border == nullptr || border->normal == glm::vec3(0.0F)) continue;
    if (crease_deg >= 180.0 || glm::dot(mesh.normals[v], border->normal) >= least_cosine)
      mesh.normals[v] = border->normal;
  }
}

}  // namespace

std::vector<Triangle> triangles_of(const hlod::NodeMesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.indices.size() / 3);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    triangles.emplace_back(mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]);
  return triangles;
}

TileMesh tile_mesh(const hlod::Hlod& hlod, hlod::NodeId n, double crease_deg, const BorderVertices& borders) {
  const hlod::NodeMesh node = hlod.mesh(n);
  TriangleMesh mesh;
  mesh.positions.assign(node.positions.begin(), node.positions.end());
  mesh.normals.assign(node.normals.begin(), node.normals.end());
  mesh.colors.assign(node.colors.begin(), node.colors.end());
  mesh.texture_coordinates.assign(node.texture_coordinates.begin(), node.texture_coordinates.end());
  mesh.triangles = triangles_of(node);
  mesh.materials.resize(hlod.data().materials.size());
  if (!mesh.normals.empty()) {
    take_materials(mesh, node);
    return {std::move(mesh)};
  }
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return !has_area(mesh, t); });
  if (mesh.triangles.empty()) return {};
  take_materials(mesh, node);
  // Normals are smooth across seams of textures: there vertices become wedges of one.
  if (hlod.data().has_seams) mesh = clean(std::move(mesh), {}, "tile").mesh;
  mesh = crease_normals(mesh, crease_deg);
  if (!mesh.corners.empty()) mesh.triangles = std::move(mesh.corners);
  mesh.corners.clear();
  mesh.extra_wedges.clear();
  take_border_normals(mesh, crease_deg, borders);
  return {std::move(mesh)};
}

}  // namespace occlod::tiles
