#include "oracle/bound_rays.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <variant>

namespace occlod::test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr RayRange nothing = {infinity, -infinity};

RayRange both(const RayRange& a, const RayRange& b) { return {std::max(a.begin, b.begin), std::min(a.end, b.end)}; }

// low <= origin + t direction <= high.
RayRange slab(double origin, double direction, double low, double high) {
  if (direction == 0.0) return origin >= low && origin <= high ? RayRange{} : nothing;
  const double a = (low - origin) / direction, b = (high - origin) / direction;
  return {std::min(a, b), std::max(a, b)};
}

// a t^2 + 2 b t + c <= 0 with a >= 0.
RayRange below_zero(double a, double b, double c) {
  if (a == 0.0) return c <= 0.0 ? RayRange{} : nothing;
  const double square = b * b - a * c;
  if (square < 0.0) return nothing;
  const double root = std::sqrt(square);
  return {(-b - root) / a, (-b + root) / a};
}

// Moeller & Trumbore 1997. None for a ray along the triangle's plane.
std::optional<double> hit(const Ray& ray, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 u = b - a, v = c - a, p = glm::cross(ray.direction, v);
  const double det = glm::dot(u, p);
  if (det == 0.0) return std::nullopt;
  const glm::dvec3 s = ray.origin - a, q = glm::cross(s, u);
  const double x = glm::dot(s, p) / det, y = glm::dot(ray.direction, q) / det;
  if (!(x >= 0.0 && y >= 0.0 && x + y <= 1.0)) return std::nullopt;
  return glm::dot(v, q) / det;
}

struct Intersect {
  const Ray& ray;

  RayRange operator()(const Sphere& sphere) const {
    const glm::dvec3 from = ray.origin - glm::dvec3(sphere.center);
    const double r = sphere.radius;
    return below_zero(glm::dot(ray.direction, ray.direction), glm::dot(ray.direction, from),
                      glm::dot(from, from) - r * r);
  }
  RayRange operator()(const Box& box) const {
    RayRange range;
    for (int axis = 0; axis < 3; ++axis)
      range = both(range, slab(ray.origin[axis], ray.direction[axis], box.min[axis], box.max[axis]));
    return range;
  }
  RayRange operator()(const Cylinder& cylinder) const {
    const glm::dvec3 axis(cylinder.axis);
    const glm::dvec3 from = ray.origin - glm::dvec3(cylinder.center);
    const double along_from = glm::dot(from, axis), along = glm::dot(ray.direction, axis);
    const glm::dvec3 across_from = from - along_from * axis, across = ray.direction - along * axis;
    const double r = cylinder.radius;
    return both(
        below_zero(glm::dot(across, across), glm::dot(across, across_from), glm::dot(across_from, across_from) - r * r),
        slab(along_from, along, cylinder.t_min, cylinder.t_max));
  }
  // The hull's surface is made of triangles of its points, and no triangle of them reaches out of it.
  RayRange operator()(const PointHull& hull) const {
    RayRange range = nothing;
    for (std::size_t i = 0; i < hull.points.size(); ++i)
      for (std::size_t j = i + 1; j < hull.points.size(); ++j)
        for (std::size_t k = j + 1; k < hull.points.size(); ++k)
          if (const std::optional<double> t = hit(ray, hull.points[i], hull.points[j], hull.points[k]))
            range = {std::min(range.begin, *t), std::max(range.end, *t)};
    return range;
  }
};

}  // namespace

RayRange range_inside(const Ray& ray, const VisibilityQuery& bound) { return std::visit(Intersect{ray}, bound.shape); }

}  // namespace occlod::test
