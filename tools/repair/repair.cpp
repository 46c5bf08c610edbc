#include "repair/repair.h"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <utility>
#include <vector>

#include "repair/array_hash.h"
#include "repair/collinear_faces.h"
#include "repair/fill_holes.h"
#include "repair/give_attributes.h"
#include "repair/orient.h"
#include "repair/weld.h"

namespace occlod::repair {
namespace {

// Drops triangles for which `is_dropped(t)`, called in order, is true, with their attributes. Returns how many.
template <class IsDropped>
std::size_t drop_triangles(TriangleMesh& mesh, IsDropped is_dropped) {
  std::size_t kept = 0;
  const std::size_t before = mesh.triangle_count();
  for (std::size_t t = 0; t < before; ++t) {
    if (is_dropped(mesh.triangles[t])) continue;
    mesh.triangles[kept] = mesh.triangles[t];
    if (!mesh.corners.empty()) mesh.corners[kept] = mesh.corners[t];
    if (!mesh.triangle_materials.empty()) mesh.triangle_materials[kept] = mesh.triangle_materials[t];
    ++kept;
  }
  mesh.triangles.resize(kept);
  if (!mesh.corners.empty()) mesh.corners.resize(kept);
  if (!mesh.triangle_materials.empty()) mesh.triangle_materials.resize(kept);
  return before - kept;
}

void weld(TriangleMesh& mesh, double distance, RepairCounts& counts) {
  const std::vector<VertexId> targets = weld_targets(mesh, distance);
  for (VertexId v = 0; v < targets.size(); ++v) counts.vertices_welded += targets[v] == v ? 0U : 1U;
  for (Triangle& t : mesh.triangles) t = {targets[t.x], targets[t.y], targets[t.z]};
  counts.collapsed_dropped =
      drop_triangles(mesh, [](const Triangle& t) { return t.x == t.y || t.y == t.z || t.z == t.x; });
}

bool is_odd(const Triangle& t) { return ((t.x > t.y) != (t.y > t.z)) != (t.z > t.x); }

// Keeps the first of triangles with the same corners.
void drop_repeated(TriangleMesh& mesh, RepairCounts& counts) {
  using Corners = std::array<VertexId, 3>;
  std::unordered_map<Corners, bool, ArrayHash<Corners>> first_is_odd;
  first_is_odd.reserve(mesh.triangle_count());
  drop_triangles(mesh, [&](const Triangle& t) {
    Corners key = {t.x, t.y, t.z};
    std::sort(key.begin(), key.end());
    const auto [first, is_new] = first_is_odd.emplace(key, is_odd(t));
    if (!is_new) ++(first->second == is_odd(t) ? counts.repeated_dropped : counts.opposite_dropped);
    return !is_new;
  });
}

}  // namespace

RepairedMesh repair_mesh(const TriangleMesh& mesh, const RepairOptions& options) {
  const auto tell = [&](const char* what, std::optional<double> done) {
    if (options.progress) options.progress(what, done);
  };
  RepairCounts counts;
  TriangleMesh soup = mesh;
  if (options.weld > 0.0) {
    tell("welding", std::nullopt);
    weld(soup, options.weld, counts);
  }
  drop_repeated(soup, counts);
  tell("orienting", std::nullopt);
  HalfedgeMesh halfedges = oriented_mesh(soup_of(soup), counts);
  tell("removing triangles without area", std::nullopt);
  remove_collinear_faces(halfedges, counts);
  fill_holes(
      halfedges, options.fill_holes, [&](double done) { tell("filling holes", done); }, counts);
  std::vector<VertexId> sources;
  RepairedMesh result{triangle_mesh_of(std::move(halfedges), soup, sources), counts};
  give_attributes(result.mesh, sources, soup);
  return result;
}

}  // namespace occlod::repair
