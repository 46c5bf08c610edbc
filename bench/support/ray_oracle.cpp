#include "support/ray_oracle.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <optional>
#include <variant>

#include "occlod/occlusion/screen_bounds.h"

namespace occlod::bench {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Ray {
  glm::dvec3 origin, direction;
};

// A range of ray parameters; empty where begin > end.
struct Range {
  double begin = -infinity;
  double end = infinity;

  [[nodiscard]] Range operator&(const Range& other) const {
    return {std::max(begin, other.begin), std::min(end, other.end)};
  }
};

constexpr Range nothing = {infinity, -infinity};

// low <= origin + t direction <= high.
Range slab(double origin, double direction, double low, double high) {
  if (direction == 0.0) return origin >= low && origin <= high ? Range{} : nothing;
  const double a = (low - origin) / direction, b = (high - origin) / direction;
  return {std::min(a, b), std::max(a, b)};
}

// a t^2 + 2 b t + c <= 0 with a >= 0.
Range below_zero(double a, double b, double c) {
  if (a == 0.0) return c <= 0.0 ? Range{} : nothing;
  const double square = b * b - a * c;
  if (square < 0.0) return nothing;
  const double root = std::sqrt(square);
  return {(-b - root) / a, (-b + root) / a};
}

struct Intersect {
  const Ray& ray;

  Range operator()(const Sphere& sphere) const {
    const glm::dvec3 from = ray.origin - glm::dvec3(sphere.center);
    const double r = sphere.radius;
    return below_zero(glm::dot(ray.direction, ray.direction), glm::dot(ray.direction, from),
                      glm::dot(from, from) - r * r);
  }
  Range operator()(const Box& box) const {
    Range range;
    for (int axis = 0; axis < 3; ++axis)
      range = range & slab(ray.origin[axis], ray.direction[axis], box.min[axis], box.max[axis]);
    return range;
  }
  Range operator()(const Cylinder& cylinder) const {
    const glm::dvec3 axis(cylinder.axis);
    const glm::dvec3 from = ray.origin - glm::dvec3(cylinder.center);
    const double along_from = glm::dot(from, axis), along = glm::dot(ray.direction, axis);
    const glm::dvec3 across_from = from - along_from * axis, across = ray.direction - along * axis;
    const double r = cylinder.radius;
    return below_zero(glm::dot(across, across), glm::dot(across, across_from),
                      glm::dot(across_from, across_from) - r * r) &
           slab(along_from, along, cylinder.t_min, cylinder.t_max);
  }
  Range operator()(const PointHull&) const { return nothing; }
};

// Rays through pixel centres whose parameter is w.
class Eye {
 public:
  Eye(const View& view, const ObjectView& object)
      : size_(view.width(), view.height()),
        to_object_(glm::inverse(glm::dmat4(object.object_to_clip()))),
        w_(glm::row(object.object_to_clip(), 3)) {
    // Where x = y = w = 0.
    const glm::dvec4 eye = to_object_ * glm::dvec4(0.0, 0.0, 1.0, 0.0);
    eye_ = glm::dvec3(eye) / eye.w;
  }

  [[nodiscard]] Ray through(int x, int y) const {
    const glm::dvec2 ndc = (glm::dvec2(x, y) + 0.5) / size_ * 2.0 - 1.0;
    const glm::dvec4 far = to_object_ * glm::dvec4(ndc.x, -ndc.y, 0.5, 1.0);
    const glm::dvec3 p = glm::dvec3(far) / far.w;
    return {eye_, (p - eye_) / (glm::dot(glm::dvec3(w_), p) + w_.w)};
  }

 private:
  glm::dvec2 size_;
  glm::dmat4 to_object_;
  glm::dvec4 w_;
  glm::dvec3 eye_{0.0};
};

}  // namespace

RayVerdict cast_rays(const View& view, const ObjectView& object, const VisibilityQuery& query,
                     const DepthBuffer& occluder) {
  // Rays beside the rectangle miss the bound.
  const std::optional<ScreenBounds> bounds = screen_bounds(view, object, query);
  const PixelRect rect = bounds ? bounds->rect : PixelRect{0, 0, view.width(), view.height()};
  const Eye eye(view, object);
  RayVerdict verdict;
  for (int y = rect.y0; y < rect.y1; ++y) {
    for (int x = rect.x0; x < rect.x1; ++x) {
      const Ray ray = eye.through(x, y);
      const Range range = std::visit(Intersect{ray}, query.shape);
      if (range.begin > range.end || range.end <= 0.0) continue;
      ++verdict.covered;
      const double front = std::max(range.begin, 0.0);
      const auto pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width()) + static_cast<std::size_t>(x);
      if (front * occluder.inverse_depth[pixel] <= 1.0) ++verdict.visible;
    }
  }
  return verdict;
}

}  // namespace occlod::bench
