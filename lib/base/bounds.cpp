#include "occlod/bounds.h"

#include <cassert>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/arithmetic.h"

namespace occlod {

Box bounding_box(std::span<const glm::vec3> points) {
  assert(!points.empty());
  Box box{points[0], points[0]};
  for (const glm::vec3& p : points) {
    box.min = glm::min(box.min, p);
    box.max = glm::max(box.max, p);
  }
  return box;
}

glm::vec3 corner(const Box& box, int i) {
  return {(i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
          (i & 4) != 0 ? box.max.z : box.min.z};
}

bool faces_away(const NormalCone& cone, const Sphere& sphere, const glm::vec3& eye) {
  if (!cone.culls()) return false;
  // A face with normal n through p faces away iff dot(n, p - eye) > 0. With d = center - eye and angle a between d and
  // the cone's axis, the smallest dot(n, d) over the cone is |d| cos(a + half angle); points of the sphere take away at
  // most its radius.
  const glm::dvec3 axis(cone.axis), d = glm::dvec3(sphere.center) - glm::dvec3(eye);
  const double along = glm::dot(d, axis);
  if (!(along > 0.0)) return false;
  // This is more exact than the root of |d|^2 - along^2, which is mostly rounding error where d is near the axis.
  const double across = glm::length(d - along * axis);
  const double cos_angle = cone.cos_angle, sin_angle = std::sqrt((1.0 - cos_angle) * (1.0 + cos_angle));
  const double smallest = along * cos_angle - across * sin_angle;
  const double slack = facing_slack * (along + across) + eye_slack * static_cast<double>(largest_coordinate(eye));
  return smallest > static_cast<double>(sphere.radius) + slack;
}

}  // namespace occlod
