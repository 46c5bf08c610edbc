#include "occlod/math/bounds.h"

#include <cassert>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

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
  const glm::vec3 d = sphere.center - eye;
  const float along = glm::dot(d, cone.axis);
  if (!(along > 0.0F)) return false;
  const float across = std::sqrt(std::fmax(0.0F, glm::dot(d, d) - along * along));
  const float sin_angle = std::sqrt(std::fmax(0.0F, (1.0F - cone.cos_angle) * (1.0F + cone.cos_angle)));
  const float smallest = along * cone.cos_angle - across * sin_angle;
  const float slack = 1e-5F * (along + across + sphere.radius);
  return smallest > sphere.radius + slack;
}

}  // namespace occlod
