#include "splits/active_faces.h"

#include <algorithm>

#include "occlod/hierarchy/cut_mesh.h"

namespace occlod {

ActiveFaces::ActiveFaces(const Hierarchy& hierarchy) : hierarchy_(hierarchy), count_(hierarchy.base_triangle_count()) {
  auto next = static_cast<std::uint32_t>(hierarchy.base_triangle_count());
  first_.reserve(hierarchy.split_count() + 1);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    first_.push_back(next);
    next += hierarchy.star(s).inserted_count();
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
  return ref.split == no_id ? hierarchy.data().base_faces[ref.slot] : hierarchy.star(ref.split).inserted(ref.slot);
}

bool same_triangle(const Triangle& a, const Triangle& b) {
  return a == b || a == Triangle(b.y, b.z, b.x) || a == Triangle(b.z, b.x, b.y);
}

namespace {

// Calls visit(FaceRef, Triangle) for each.
template <typename Visit>
void for_each_active(const Hierarchy& hierarchy, const std::vector<bool>& applied, const Visit& visit) {
  ActiveFaces active(hierarchy);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    if (!applied[s]) continue;
    active.apply(s);
    hierarchy.star(s).for_each_removed([&](const FaceRef& ref, const Triangle&) { active.remove(ref); });
  }
  const std::span<const Triangle> base = hierarchy.data().base_faces;
  for (std::uint32_t slot = 0; slot < base.size(); ++slot)
    if (active.active({no_id, slot})) visit(FaceRef{no_id, slot}, base[slot]);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    if (!applied[s]) continue;
    const SplitStar star = hierarchy.star(s);
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

}  // namespace occlod
