#include "hlod/build/level_draft.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "base/threads.h"
#include "mesh/wedges.h"
#include "splits/attribute_state.h"
#include "splits/spatial_order.h"

namespace occlod::hlod {

namespace {

// `mesh` has wedges for each feature.
WedgeMesh in_order(const TriangleMesh& mesh, unsigned threads) {
  WedgeMesh result;
  const WedgeOrder order = spatial_order_of(mesh, in_order_of_use(mesh.triangles, mesh.vertex_count()), threads);
  // Simplification adds wedges where there are seams; arrays without room for them would be copied.
  const std::size_t room = mesh.extra_wedges.empty() ? 0 : mesh.wedge_count() / 8;
  const auto permute = [&](const auto& from, auto& to) {
    if (!from.empty()) to.reserve(from.size() + room);
    to.resize(from.size());
    for_each_id(from.size(), threads, [&](std::uint32_t i) { to[i] = from[order.old_id[i]]; });
  };
  permute(mesh.positions, result.positions);
  permute(mesh.normals, result.normals);
  permute(mesh.colors, result.colors);
  permute(mesh.texture_coordinates, result.texture_coordinates);
  permute(wedge_materials(mesh), result.wedge_materials);
  permute(wedge_features(mesh), result.wedge_features);
  for (std::size_t i = mesh.vertex_count(); i < mesh.wedge_count(); ++i)
    result.extra_wedges.push_back(order.new_id[mesh.vertex_of(order.old_id[i])]);
  const auto renumber = [&](const std::vector<Triangle>& from, UninitializedVector<Triangle>& to) {
    to.resize(from.size());
    for_each_id(from.size(), threads, [&](std::uint32_t f) {
      for (int k = 0; k < 3; ++k) to[f][k] = order.new_id[from[f][k]];
    });
  };
  renumber(mesh.triangles, result.triangles);
  renumber(mesh.corners, result.corners);
  result.materials = mesh.materials;
  result.textures = mesh.textures;
  result.texture_origin = mesh.texture_origin;
  result.origin = mesh.origin;
  result.up = mesh.up;
  if (!result.wedge_features.empty()) result.feature_names = mesh.feature_names;
  return result;
}

}  // namespace

WedgeMesh to_wedge_mesh(const TriangleMesh& mesh, unsigned threads) {
  const std::vector<FeatureId>& features = mesh.triangle_features;
  const bool has_several = std::ranges::adjacent_find(features, std::ranges::not_equal_to{}) != features.end();
  if (features.empty()) return in_order(mesh, threads);
  TriangleMesh parted = mesh;
  if (!has_several) parted.triangle_features.clear();
  return in_order(has_several ? part_features(std::move(parted)) : parted, threads);
}

}  // namespace occlod::hlod
