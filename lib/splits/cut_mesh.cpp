#include <algorithm>
#include <cassert>
#include <cmath>

#include "occlod/build_hierarchy.h"
#include "splits/active_faces.h"
#include "splits/compact_mesh.h"
#include "splits/star.h"

namespace occlod {

ActiveFaces::ActiveFaces(const Hierarchy& hierarchy) : hierarchy_(hierarchy), count_(hierarchy.base_triangle_count()) {
  auto next = static_cast<std::uint32_t>(hierarchy.base_triangle_count());
  first_.reserve(hierarchy.split_count() + 1);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    first_.push_back(next);
    next += star_of(hierarchy, s).inserted_count();
  }
  first_.push_back(next);
  active_.resize(next, false);
  std::fill_n(active_.begin(), hierarchy.base_triangle_count(), true);
}

void ActiveFaces::apply(SplitId s) {
  std::fill(active_.begin() + first_[s], active_.begin() + first_[s + 1], true);
  count_ += first_[s + 1] - first_[s];
}

bool ActiveFaces::remove(const FaceRef& ref) {
  const std::size_t end = ref.split == no_id ? hierarchy_.base_triangle_count() : first_[ref.split + 1];
  const std::size_t place = place_of(ref);
  if (place >= end || !active_[place]) return false;
  active_[place] = false;
  --count_;
  return true;
}

Triangle face_at(const Hierarchy& hierarchy, const FaceRef& ref) {
  return ref.split == no_id ? hierarchy.data().base_faces[ref.slot] : star_of(hierarchy, ref.split).inserted(ref.slot);
}

bool same_triangle(const Triangle& a, const Triangle& b) {
  return a == b || a == Triangle(b.y, b.z, b.x) || a == Triangle(b.z, b.x, b.y);
}

namespace {

// Calls visit(FaceRef, Triangle) for each active face.
template <typename Visit>
void for_each_active(const Hierarchy& hierarchy, const std::vector<bool>& applied, const Visit& visit) {
  ActiveFaces active(hierarchy);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    if (!applied[s]) continue;
    active.apply(s);
    star_of(hierarchy, s).for_each_removed([&](const FaceRef& ref, const Triangle&) { active.remove(ref); });
  }
  const std::span<const Triangle> base = hierarchy.data().base_faces;
  for (std::uint32_t slot = 0; slot < base.size(); ++slot)
    if (active.active({no_id, slot})) visit(FaceRef{no_id, slot}, base[slot]);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    if (!applied[s]) continue;
    const SplitStar star = star_of(hierarchy, s);
    for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot)
      if (active.active({s, slot})) visit(FaceRef{s, slot}, star.inserted(slot));
  }
}

}  // namespace

std::vector<Triangle> active_triangles(const Hierarchy& hierarchy, const std::vector<bool>& applied) {
  std::vector<Triangle> triangles;
  for_each_active(hierarchy, applied, [&](const FaceRef&, const Triangle& t) { triangles.push_back(t); });
  return triangles;
}

std::vector<Triangle> active_wedge_triangles(const Hierarchy& hierarchy, const std::vector<bool>& applied) {
  std::vector<Triangle> triangles;
  for_each_active(hierarchy, applied, [&](const FaceRef& face, const Triangle& t) {
    triangles.push_back(wedges_of_face(hierarchy, face, t));
  });
  return triangles;
}

namespace {

// Returns the number of triangles after split s, given the number before it.
std::size_t grown(const Hierarchy& hierarchy, std::size_t triangles, SplitId s) {
  const SplitStar star = star_of(hierarchy, s);
  return triangles + star.inserted_count() - star.removed_count();
}

template <class IsApplied>
FixedCut make_cut(const Hierarchy& hierarchy, const IsApplied& is_applied) {
  hierarchy.require_all();
  FixedCut cut;
  cut.applied.resize(hierarchy.split_count());
  cut.triangles = hierarchy.base_triangle_count();
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    const SplitNode& node = hierarchy.node(s);
    if (is_applied(s)) {
      cut.applied[s] = true;
      ++cut.splits;
      cut.triangles = grown(hierarchy, cut.triangles, s);
    } else {
      cut.guaranteed_error = std::max(cut.guaranteed_error, node.guaranteed_error);
      cut.error = std::max(cut.error, std::hypot(node.error, hierarchy.attribute_error(s)));
    }
  }
  return cut;
}

}  // namespace

FixedCut full_cut(const Hierarchy& hierarchy) {
  return make_cut(hierarchy, [](SplitId) { return true; });
}

FixedCut cut_to_triangles(const Hierarchy& hierarchy, std::size_t max_triangles) {
  hierarchy.require_all();
  SplitId end = 0;
  std::size_t triangles = hierarchy.base_triangle_count();
  for (; end < hierarchy.split_count(); ++end) {
    triangles = grown(hierarchy, triangles, end);
    if (triangles > max_triangles) break;
  }
  return make_cut(hierarchy, [&](SplitId s) { return s < end; });
}

FixedCut cut_to_error(const Hierarchy& hierarchy, double max_error) {
  return make_cut(hierarchy, [&](SplitId s) {
    return std::max(hierarchy.node(s).guaranteed_error, hierarchy.attribute_error(s)) > max_error;
  });
}

std::vector<Triangle> triangles_of(const Hierarchy& hierarchy, const FixedCut& cut) {
  assert(cut.applied.size() == hierarchy.split_count());
  return active_triangles(hierarchy, cut.applied);
}

std::vector<Triangle> wedge_triangles_of(const Hierarchy& hierarchy, const FixedCut& cut) {
  if (!hierarchy.has_seams()) return triangles_of(hierarchy, cut);
  assert(cut.applied.size() == hierarchy.split_count());
  return active_wedge_triangles(hierarchy, cut.applied);
}

TriangleMesh mesh_of(const Hierarchy& hierarchy, std::span<const Triangle> wedge_triangles) {
  const HierarchyView& data = hierarchy.data();
  std::vector<Triangle> vertices;
  vertices.reserve(wedge_triangles.size());
  for (const Triangle& t : wedge_triangles)
    vertices.emplace_back(hierarchy.vertex_of_wedge(t.x), hierarchy.vertex_of_wedge(t.y),
                          hierarchy.vertex_of_wedge(t.z));
  TriangleMesh mesh = compact_mesh({data.positions, data.normals, data.colors, data.texture_coordinates}, vertices,
                                   wedge_triangles, hierarchy.vertex_count());
  if (!data.wedge_materials.empty())
    for (const Triangle& t : wedge_triangles) mesh.triangle_materials.push_back(hierarchy.material_of(t.x));
  mesh.materials = {data.materials.begin(), data.materials.end()};
  mesh.textures = {data.textures.begin(), data.textures.end()};
  mesh.texture_origin = data.texture_origin;
  mesh.origin = data.origin;
  mesh.up = data.up;
  return mesh;
}

TriangleMesh cut_mesh(const Hierarchy& hierarchy, const FixedCut& cut) {
  return mesh_of(hierarchy, wedge_triangles_of(hierarchy, cut));
}

}  // namespace occlod
