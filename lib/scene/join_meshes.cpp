#include "occlod/scene/join_meshes.h"

#include <utility>
#include <vector>

#include "scene/mesh_joiner.h"

namespace occlod {
namespace {

// The vertex of each wedge of a joined mesh, by number among all wedges.
std::vector<WedgeId> first_wedges(std::span<const PlacedMesh> meshes) {
  std::vector<WedgeId> first;
  for (const PlacedMesh& placed : meshes) {
    const auto begin = static_cast<WedgeId>(first.size());
    for (WedgeId wedge = 0; wedge < placed.mesh->wedge_count(); ++wedge)
      first.push_back(begin + placed.mesh->vertex_of(wedge));
  }
  return first;
}

template <typename T>
void reorder(std::vector<T>& values, const std::vector<WedgeId>& order) {
  if (values.empty()) return;
  std::vector<T> result;
  result.reserve(values.size());
  for (const WedgeId wedge : order) result.push_back(values[wedge]);
  values = std::move(result);
}

// Makes extra wedges of those vertices that are not their own first one: these move to the end.
void make_wedges(TriangleMesh& mesh, const std::vector<WedgeId>& first) {
  std::vector<WedgeId> order, extra, new_ids(first.size());
  for (WedgeId wedge = 0; wedge < first.size(); ++wedge) (first[wedge] == wedge ? order : extra).push_back(wedge);
  if (extra.empty()) return;
  order.insert(order.end(), extra.begin(), extra.end());
  for (WedgeId i = 0; i < order.size(); ++i) new_ids[order[i]] = i;
  reorder(mesh.positions, order);
  reorder(mesh.normals, order);
  reorder(mesh.colors, order);
  reorder(mesh.texture_coordinates, order);
  for (const WedgeId wedge : extra) mesh.extra_wedges.push_back(new_ids[first[wedge]]);
  mesh.corners = mesh.triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      mesh.corners[t][k] = new_ids[mesh.triangles[t][k]];
      mesh.triangles[t][k] = new_ids[first[mesh.triangles[t][k]]];
    }
}

}  // namespace

TriangleMesh join_meshes(std::span<const PlacedMesh> meshes, const std::filesystem::path& folder,
                         const std::string& name) {
  MeshJoiner joiner(name, folder);
  for (const PlacedMesh& placed : meshes) joiner.add(*placed.mesh, placed.object_to_world, placed.source_name);
  TriangleMesh all = joiner.finish();
  make_wedges(all, first_wedges(meshes));
  return all;
}

}  // namespace occlod
