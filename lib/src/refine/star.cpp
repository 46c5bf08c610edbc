#include "star.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace occlod {
namespace {

// Sums over the faces that are seen, of twice their area, and of that part of it that faces the eye.
struct SeenArea {
  float whole = 0.0F;
  float facing = 0.0F;

  [[nodiscard]] float cosine() const { return whole > 0.0F ? std::min(facing / whole, 1.0F) : 1.0F; }
};

// False only when all corners are outside one plane.
bool may_be_inside(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const ObjectView& view) {
  return std::all_of(view.planes().begin(), view.planes().end(), [&](const glm::vec4& plane) {
    const auto inside = [&](const glm::vec3& p) { return !(glm::dot(glm::vec3(plane), p) + plane.w < 0.0F); };
    return inside(a) || inside(b) || inside(c);
  });
}

}  // namespace

bool is_wholly_inside(const Sphere& sphere, const ObjectView& view) {
  return std::all_of(view.planes().begin(), view.planes().end(), [&](const glm::vec4& plane) {
    return glm::dot(glm::vec3(plane), sphere.center) + plane.w > sphere.radius;
  });
}

StarView StarLook::look(const Hierarchy& hierarchy, SplitId s, const ObjectView& view, bool two_sided) {
  gather(hierarchy, s);
  const Box box = bounding_box(points_);
  StarView star;
  star.sphere.center = 0.5F * box.min + 0.5F * box.max;
  for (const glm::vec3& p : points_)
    star.sphere.radius = std::max(star.sphere.radius, glm::distance(star.sphere.center, p));
  const bool inside = is_wholly_inside(star.sphere, view);
  const std::span<const glm::vec3> positions = hierarchy.positions();
  int faces = 0;
  int visible = 0;
  SeenArea seen;
  hierarchy.star(s).for_each_face([&](const Triangle& t) {
    const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
    ++faces;
    // Which side of its plane the eye is on does not change under an affine map, mirrored or not.
    const glm::vec3 normal = glm::cross(b - a, c - a), to_eye = view.eye() - a;
    const float facing = glm::dot(normal, to_eye);
    if (!((two_sided || facing > 0.0F) && (inside || may_be_inside(a, b, c, view)))) return;
    ++visible;
    seen.whole += glm::length(normal);
    seen.facing += std::abs(facing) / glm::length(to_eye);
  });
  if (faces > 0) star.visible_share = static_cast<float>(visible) / static_cast<float>(faces);
  star.cosine = seen.cosine();
  return star;
}

std::span<const glm::vec3> StarLook::points(const Hierarchy& hierarchy, SplitId s) {
  gather(hierarchy, s);
  return points_;
}

void StarLook::gather(const Hierarchy& hierarchy, SplitId s) {
  const SplitStar star = hierarchy.star(s);
  ids_.assign(1, star.vertex());
  if (star.is_fan())  // u and the corners of removed faces are in the ring
    ids_.insert(ids_.end(), star.ring().begin(), star.ring().end());
  else
    gather_corners(star);
  points_.resize(ids_.size());
  std::transform(ids_.begin(), ids_.end(), points_.begin(), [&](VertexId v) {
    hierarchy.require_vertex(v);
    return hierarchy.positions()[v];
  });
}

void StarLook::gather_corners(const SplitStar& star) {
  star.for_each_face([&](const Triangle& t) { ids_.insert(ids_.end(), {t.x, t.y, t.z}); });
  std::sort(ids_.begin(), ids_.end());
  ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
}

}  // namespace occlod
