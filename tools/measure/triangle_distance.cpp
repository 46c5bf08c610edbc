#include "triangle_distance.h"

#include <glm/geometric.hpp>

namespace occlod::measure {
namespace {

double squared_length(const glm::dvec3& v) { return glm::dot(v, v); }

// Returns the nearest point's place between a and b, in [0, 1].
double nearest_along(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& ab) {
  const double along = glm::dot(p - a, ab), length = squared_length(ab);
  if (along <= 0.0 || length <= 0.0) return 0.0;
  return along >= length ? 1.0 : along / length;
}

}  // namespace

// Ericson (Real-Time Collision Detection, sec. 5.1.5) distinguishes regions by signs that rounding flips on slivers.
// Here the sides are always candidates, and so is the foot on the plane if its barycentric coordinates are valid.
TrianglePoint nearest_on_triangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
  const glm::dvec3 normal = glm::cross(ab, ac);
  const double area = squared_length(normal);
  TrianglePoint best{a, {1.0, 0.0, 0.0}};
  double best_distance = squared_length(ap);
  const auto try_point = [&](const glm::dvec3& q, const glm::dvec3& weights) {
    const double distance = squared_length(p - q);
    if (distance < best_distance) best = {q, weights}, best_distance = distance;
  };
  const double v = glm::dot(glm::cross(ap, ac), normal) / area;
  const double w = glm::dot(glm::cross(ab, ap), normal) / area;
  // This is false if the area is 0, which makes the coordinates NaN.
  if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) try_point(a + v * ab + w * ac, {1.0 - v - w, v, w});
  const auto try_side = [&](const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& at_from,
                            const glm::dvec3& at_to) {
    const double t = nearest_along(p, from, to - from);
    try_point(t >= 1.0 ? to : from + t * (to - from), (1.0 - t) * at_from + t * at_to);
  };
  try_side(a, b, {1, 0, 0}, {0, 1, 0});
  try_side(b, c, {0, 1, 0}, {0, 0, 1});
  try_side(c, a, {0, 0, 1}, {1, 0, 0});
  return best;
}

glm::dvec3 nearest_point(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return nearest_on_triangle(p, a, b, c).point;
}

}  // namespace occlod::measure
