#include "star.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "math/inverse_power_of_two.h"

namespace occlod {
namespace {

// How many faces there are and are seen, and sums over those that are seen, of twice their area in any unit, and of
// that part of it that faces the eye.
struct SeenFaces {
  int faces = 0;
  int seen = 0;
  float whole = 0.0F;
  float facing = 0.0F;

  // 1 also for what is no number: with the eye on a corner.
  [[nodiscard]] float cosine() const { return whole > 0.0F ? std::min(1.0F, facing / whole) : 1.0F; }
};

// What lengths are multiplied with.
struct Unscaled {
  glm::vec3 operator()(const glm::vec3& v) const { return v; }
};
struct Scaled {
  float factor;
  glm::vec3 operator()(const glm::vec3& v) const { return factor * v; }
};

// False only when all corners are outside one plane.
bool may_be_inside(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const ObjectView& view) {
  return std::all_of(view.planes().begin(), view.planes().end(), [&](const glm::vec4& plane) {
    const auto inside = [&](const glm::vec3& p) { return !(glm::dot(glm::vec3(plane), p) + plane.w < 0.0F); };
    return inside(a) || inside(b) || inside(c);
  });
}

class FaceLook {
 public:
  FaceLook(std::span<const glm::vec3> positions, const ObjectView& view, bool inside, bool two_sided)
      : positions_(positions), view_(view), inside_(inside), two_sided_(two_sided) {}

  // `edges` and `rays` bring these to sizes near 1.
  template <class Scale>
  [[nodiscard]] SeenFaces look(const SplitStar& star, const Scale& edges, const Scale& rays) const {
    SeenFaces result;
    star.for_each_face([&](const Triangle& t) {
      const glm::vec3 &a = positions_[t.x], &b = positions_[t.y], &c = positions_[t.z];
      ++result.faces;
      // Which side of its plane the eye is on does not change under an affine map, mirrored or not.
      const glm::vec3 normal = glm::cross(edges(b - a), edges(c - a)), to_eye = rays(view_.eye() - a);
      const float facing = glm::dot(normal, to_eye);
      if (!((two_sided_ || facing > 0.0F) && (inside_ || may_be_inside(a, b, c, view_)))) return;
      ++result.seen;
      result.whole += glm::length(normal);
      result.facing += std::abs(facing) / glm::length(to_eye);
    });
    return result;
  }

 private:
  std::span<const glm::vec3> positions_;
  const ObjectView& view_;
  bool inside_;  // the whole star
  bool two_sided_;
};

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
  const float extent = largest_coordinate(box.max - box.min);
  const float unit = inverse_power_of_two(extent);
  float square = 0.0F;
  for (const glm::vec3& p : points_) {
    const glm::vec3 d = unit * (p - star.sphere.center);
    square = std::max(square, glm::dot(d, d));
  }
  star.sphere.radius = std::sqrt(square) / unit;
  const float distance = largest_coordinate(view.eye() - star.sphere.center);
  const FaceLook faces(hierarchy.positions(), view, is_wholly_inside(star.sphere, view), two_sided);
  const SeenFaces seen = is_near_one(extent) && is_near_one(distance)
                             ? faces.look(hierarchy.star(s), Unscaled(), Unscaled())
                             : faces.look(hierarchy.star(s), Scaled{unit}, Scaled{inverse_power_of_two(distance)});
  if (seen.faces > 0) star.visible_share = static_cast<float>(seen.seen) / static_cast<float>(seen.faces);
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
