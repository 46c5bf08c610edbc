#include "priority/star_visibility.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "math/inverse_power_of_two.h"

namespace occlod {
namespace {

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

class FaceSums {
 public:
  FaceSums(std::span<const glm::vec3> positions, const ObjectView& view, bool inside, bool two_sided)
      : positions_(positions), view_(view), inside_(inside), two_sided_(two_sided) {}

  // `edges` and `rays` bring these to sizes near 1.
  template <class Scale>
  [[nodiscard]] SeenFaces of(const SplitStar& star, const Scale& edges, const Scale& rays) const {
    SeenFaces result;
    star.for_each_face([&](const Triangle& t) {
      const glm::vec3 &a = positions_[t.x], &b = positions_[t.y], &c = positions_[t.z];
      // Which side of its plane the eye is on does not change under an affine map, mirrored or not.
      const glm::vec3 normal = glm::cross(edges(b - a), edges(c - a)), to_eye = rays(view_.eye() - a);
      const float facing = glm::dot(normal, to_eye);
      if (!((two_sided_ || facing > 0.0F) && (inside_ || may_be_inside(a, b, c, view_)))) return;
      ++result.count;
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

float distance_to(const Sphere& sphere, const ObjectView& view) {
  return largest_coordinate(view.eye() - sphere.center);
}

StarView star_view(const SplitStar& star, const Sphere& sphere, const SeenFaces& seen) {
  StarView result;
  result.sphere = sphere;
  const std::uint32_t faces = star.inserted_count() + star.removed_count();
  if (faces > 0) result.visible_share = static_cast<float>(seen.count) / static_cast<float>(faces);
  // 1 also for what is no number: with the eye on a corner.
  if (seen.whole > 0.0F) result.cosine = std::min(1.0F, seen.facing / seen.whole);
  return result;
}

}  // namespace

bool is_wholly_inside(const Sphere& sphere, const ObjectView& view) {
  return std::all_of(view.planes().begin(), view.planes().end(), [&](const glm::vec4& plane) {
    return glm::dot(glm::vec3(plane), sphere.center) + plane.w > sphere.radius;
  });
}

StarView StarVisibility::evaluate(const Hierarchy& hierarchy, SplitId s, const ObjectView& view, bool two_sided) {
  const SplitStar star = hierarchy.star(s);
  if (star.is_fan()) {
    gather_fan(hierarchy, star);
    const Sphere sphere = sphere_around(fan_);  // its radius is not near one where squares are out of range
    if (is_near_one(sphere.radius) && is_near_one(distance_to(sphere, view)) && is_wholly_inside(sphere, view))
      return star_view(star, sphere, fan_visibility(fan_, view.eye(), two_sided));
  }
  gather(hierarchy, s);
  const Box box = bounding_box(points_);
  Sphere sphere;
  sphere.center = 0.5F * box.min + 0.5F * box.max;
  const float extent = largest_coordinate(box.max - box.min), distance = distance_to(sphere, view);
  const float unit = inverse_power_of_two(extent);
  float square = 0.0F;
  for (const glm::vec3& p : points_) {
    const glm::vec3 d = unit * (p - sphere.center);
    square = std::max(square, glm::dot(d, d));
  }
  sphere.radius = std::sqrt(square) / unit;
  const FaceSums faces(hierarchy.positions(), view, is_wholly_inside(sphere, view), two_sided);
  const SeenFaces seen = is_near_one(extent) && is_near_one(distance)
                             ? faces.of(star, Unscaled(), Unscaled())
                             : faces.of(star, Scaled{unit}, Scaled{inverse_power_of_two(distance)});
  return star_view(star, sphere, seen);
}

std::span<const glm::vec3> StarVisibility::points(const Hierarchy& hierarchy, SplitId s) {
  gather(hierarchy, s);
  return points_;
}

void StarVisibility::gather(const Hierarchy& hierarchy, SplitId s) {
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

void StarVisibility::gather_fan(const Hierarchy& hierarchy, const SplitStar& star) {
  const std::span<const glm::vec3> positions = hierarchy.positions();
  const std::span<const VertexId> ring = star.ring();
  fan_.vertex = positions[star.vertex()];
  fan_.ring_size = static_cast<std::uint32_t>(ring.size());
  fan_.inserted = star.inserted_count();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    hierarchy.require_vertex(ring[i]);
    fan_.set(i, positions[ring[i]]);
    if (ring[i] == star.parent_vertex()) fan_.parent_place = static_cast<std::uint32_t>(i);
  }
  fan_.fill_up();
}

void StarVisibility::gather_corners(const SplitStar& star) {
  star.for_each_face([&](const Triangle& t) { ids_.insert(ids_.end(), {t.x, t.y, t.z}); });
  std::sort(ids_.begin(), ids_.end());
  ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
}

}  // namespace occlod
