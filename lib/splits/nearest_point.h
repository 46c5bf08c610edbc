// Finds the point of a triangle that is nearest to another point.
#pragma once

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace occlod {

[[nodiscard]] inline double squared_length(const glm::dvec3& v) { return glm::dot(v, v); }

// Holds a point of a triangle by the weights of its corners, and its squared distance.
struct NearestPoint {
  glm::dvec3 weights{0.0};
  double distance2 = std::numeric_limits<double>::infinity();
};

// Returns the point of the triangle a, b, c that is nearest to p. The foot on the plane counts where it lies inside,
// and the three sides always, so that rounding does no harm to triangles without area.
[[nodiscard]] inline NearestPoint nearest_point(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                                                const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a, normal = glm::cross(ab, ac);
  const double area2 = squared_length(normal);
  if (area2 > 0.0) {
    const double v = glm::dot(glm::cross(ap, ac), normal), w = glm::dot(glm::cross(ab, ap), normal);
    if (v >= 0.0 && w >= 0.0 && v + w <= area2) {
      const double height = glm::dot(ap, normal);
      return {{1.0 - (v + w) / area2, v / area2, w / area2}, height * height / area2};
    }
  }
  NearestPoint best;
  const auto try_side = [&](const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& at_from,
                            const glm::dvec3& at_to) {
    const glm::dvec3 along = to - from;
    const double length2 = squared_length(along);
    const double t = length2 > 0.0 ? std::clamp(glm::dot(p - from, along) / length2, 0.0, 1.0) : 0.0;
    const glm::dvec3 off = p - (from + t * along);
    if (const double distance2 = squared_length(off); distance2 < best.distance2)
      best = {(1.0 - t) * at_from + t * at_to, distance2};
  };
  try_side(a, b, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0});
  try_side(b, c, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0});
  try_side(c, a, {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0});
  return best;
}

}  // namespace occlod
