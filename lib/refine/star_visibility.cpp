#include "refine/star_visibility.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/arithmetic.h"
#include "splits/star.h"

namespace occlod {
namespace {

// These scale vectors by 1 and by a factor.
struct Unscaled {
  glm::vec3 operator()(const glm::vec3& v) const { return v; }
};
struct Scaled {
  float factor;
  glm::vec3 operator()(const glm::vec3& v) const { return factor * v; }
};

// Returns false only when all corners are outside one plane.
bool may_be_inside(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const ObjectView& view) {
  return std::all_of(view.planes().begin(), view.planes().end(), [&](const glm::vec4& plane) {
    const auto inside = [&](const glm::vec3& p) { return !(glm::dot(glm::vec3(plane), p) + plane.w < 0.0F); };
    return inside(a) || inside(b) || inside(c);
  });
}

struct SeenFaces {
  float count = 0.0F;
  float whole = 0.0F;   // twice the sum of their areas
  float facing = 0.0F;  // twice the sum of their areas as seen from the eye
};

class FaceSums {
 public:
  FaceSums(std::span<const glm::vec3> positions, const ObjectView& view, bool inside, bool two_sided)
      : positions_(positions), view_(view), inside_(inside), two_sided_(two_sided) {}

  // Returns sums over the faces that are seen. `edges` and `rays` scale these to sizes near 1.
  template <class Scale>
  [[nodiscard]] SeenFaces of(const SplitStar& star, const Scale& edges, const Scale& rays) const {
    SeenFaces result;
    star.for_each_face([&](const Triangle& t) {
      const glm::vec3 &a = positions_[t.x], &b = positions_[t.y], &c = positions_[t.z];
      // An affine map, mirrored or not, does not change the side of a face's plane on which the eye is.
      const glm::vec3 normal = glm::cross(edges(b - a), edges(c - a)), to_eye = rays(view_.eye() - a);
      const float facing = glm::dot(normal, to_eye);
      if (!((two_sided_ || facing > 0.0F) && (inside_ || may_be_inside(a, b, c, view_)))) return;
      result.count += 1.0F;
      result.whole += glm::length(normal);
      result.facing += std::abs(facing) / glm::length(to_eye);
    });
    return result;
  }

 private:
  std::span<const glm::vec3> positions_;
  const ObjectView& view_;
  bool inside_;  // whether the whole star is inside the frustum
  bool two_sided_;
};

float distance_to(const Sphere& sphere, const ObjectView& view) {
  return largest_coordinate(view.eye() - sphere.center);
}

StarView star_view(const SplitStar& star, const Sphere& sphere, float scale_px, const SeenFaces& seen) {
  StarView result;
  result.sphere = sphere;
  result.scale_px = scale_px;
  const std::uint32_t faces = star.inserted_count() + star.removed_count();
  if (faces > 0) result.visible_share = seen.count / static_cast<float>(faces);
  // The result is 1 also for NaN, with the eye on a corner.
  if (seen.whole > 0.0F) result.cosine = std::min(1.0F, seen.facing / seen.whole);
  return result;
}

// Returns whether all of the fan is inside the frustum, and squares of what is computed stay in the range of floats.
bool is_found(const FanViews& fans, std::size_t i, const ObjectView& view) {
  return fans.room_inside[i] > 0.0F && is_near_one(fans.radius[i]) && is_near_one(distance_to(fans.sphere(i), view));
}

}  // namespace

bool is_wholly_inside(const Sphere& sphere, const ObjectView& view) {
  return std::all_of(view.planes().begin(), view.planes().end(), [&](const glm::vec4& plane) {
    return glm::dot(glm::vec3(plane), sphere.center) + plane.w > sphere.radius;
  });
}

// Evaluates fans in batches and other stars one by one.
void StarVisibility::evaluate(const Hierarchy& hierarchy, std::span<const SplitId> splits, const ObjectView& view,
                              bool two_sided, std::span<StarView> stars) {
  assert(stars.size() >= splits.size());
  const std::span<const glm::vec3> positions = hierarchy.positions();
  FanViews views;
  std::array<std::size_t, FanBatch::capacity> places;
  const auto evaluate_fans = [&] {
    find_fan_views(fans_, view, two_sided, views);
    for (std::size_t k = 0; k < fans_.size(); ++k) {
      const SplitId s = splits[places[k]];
      stars[places[k]] = is_found(views, k, view) ? star_view(star_of(hierarchy, s), views.sphere(k), views.scale_px[k],
                                                              {views.faces[k], views.whole[k], views.facing[k]})
                                                  : evaluate_faces(hierarchy, s, view, two_sided);
    }
    fans_.clear();
  };
  for (std::size_t i = 0; i < splits.size(); ++i) {
    const SplitStar star = star_of(hierarchy, splits[i]);
    if (!star.is_fan()) {
      stars[i] = evaluate_faces(hierarchy, splits[i], view, two_sided);
      continue;
    }
    for (const VertexId v : star.ring()) hierarchy.require_vertex(v);
    places[fans_.size()] = i;
    fans_.add(star, positions);
    if (fans_.size() == FanBatch::capacity) evaluate_fans();
  }
  if (fans_.size() > 0) evaluate_fans();
}

// Evaluates a star of any kind face by face.
StarView StarVisibility::evaluate_faces(const Hierarchy& hierarchy, SplitId s, const ObjectView& view, bool two_sided) {
  const SplitStar star = star_of(hierarchy, s);
  const Box box = bounding_box(points(hierarchy, s));
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
  return star_view(star, sphere, view.largest_scale_px(sphere), seen);
}

void StarVisibility::append_points(const Hierarchy& hierarchy, SplitId s, std::vector<glm::vec3>& points) {
  const SplitStar star = star_of(hierarchy, s);
  const auto append = [&](VertexId v) {
    hierarchy.require_vertex(v);
    points.push_back(hierarchy.positions()[v]);
  };
  append(star.vertex());
  if (star.is_fan()) {  // the ring contains u and the corners of removed faces
    std::for_each(star.ring().begin(), star.ring().end(), append);
    return;
  }
  thread_local std::vector<VertexId> ids;
  ids.clear();
  star.for_each_face([&](const Triangle& t) { ids.insert(ids.end(), {t.x, t.y, t.z}); });
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  for (const VertexId v : ids)
    if (v != star.vertex()) append(v);
}

}  // namespace occlod
