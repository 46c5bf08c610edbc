#include "triangle_distance.h"

#include <glm/geometric.hpp>

namespace occlod::measure {
namespace {

double squared_length(const glm::dvec3& v) { return glm::dot(v, v); }

glm::dvec3 nearest_on_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 ab = b - a;
  const double along = glm::dot(p - a, ab), length = squared_length(ab);
  if (along <= 0.0 || length <= 0.0) return a;
  if (along >= length) return b;
  return a + (along / length) * ab;
}

}  // namespace

// Ericson (Real-Time Collision Detection, sec. 5.1.5) tells regions apart by signs that rounding turns round on
// slivers. Here the sides are always candidates, and the foot on the plane is one when its barycentric coordinates are
// sound.
glm::dvec3 nearest_point(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
  const glm::dvec3 normal = glm::cross(ab, ac);
  const double area = squared_length(normal);
  glm::dvec3 best = a;
  double best_distance = squared_length(ap);
  const auto try_point = [&](const glm::dvec3& q) {
    const double distance = squared_length(p - q);
    if (distance < best_distance) best = q, best_distance = distance;
  };
  const double v = glm::dot(glm::cross(ap, ac), normal) / area;
  const double w = glm::dot(glm::cross(ab, ap), normal) / area;
  if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) try_point(a + v * ab + w * ac);  // false where area is 0: not a number
  try_point(nearest_on_segment(p, a, b));
  try_point(nearest_on_segment(p, b, c));
  try_point(nearest_on_segment(p, c, a));
  return best;
}

}  // namespace occlod::measure
