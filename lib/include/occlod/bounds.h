// Bounding volumes and normal cones, in object space and object units. They have single precision; those that the
// library computes are rounded outwards.
#pragma once

#include <glm/vec3.hpp>
#include <span>

namespace occlod {

// All points no farther than `radius` from `center`.
struct Sphere {
  glm::vec3 center{0.0F};  // object space
  float radius = 0.0F;     // >= 0
};

// An axis-aligned box.
struct Box {
  glm::vec3 min{0.0F};  // object space
  glm::vec3 max{0.0F};  // min <= max in every axis
};

// A capped cylinder around the line center + t * axis, t in [t_min, t_max].
struct Cylinder {
  glm::vec3 center{0.0F};            // a point of the line, object space
  float radius = 0.0F;               // >= 0
  glm::vec3 axis{0.0F, 0.0F, 1.0F};  // unit length
  float t_min = 0.0F;                // object units along the axis
  float t_max = 0.0F;                // >= t_min
};

// A cone of directions: all unit vectors n with dot(n, axis) >= cos_angle. With cos_angle <= 0 it bounds nothing and
// never culls.
struct NormalCone {
  glm::vec3 axis{0.0F, 0.0F, 1.0F};  // unit length
  float cos_angle = -1.0F;           // cosine of the angle between the axis and the boundary

  // True when the cone bounds its normals, so that faces_away() can be true.
  [[nodiscard]] bool culls() const noexcept { return cos_angle > 0.0F; }
};

// Returns the smallest axis-aligned box around `points`, which has at least one point. O(n).
[[nodiscard]] Box bounding_box(std::span<const glm::vec3> points);

// Returns corner i of a box, 0 <= i < 8: it has max.x iff bit 0 of i is set, max.y iff bit 1, max.z iff bit 2.
[[nodiscard]] glm::vec3 corner(const Box& box, int i);

// True only when all surface inside `sphere` with normals inside `cone` faces away from an eye at `eye` (object space),
// so that none of its front faces can be seen. Conservative: rounding of the bounds and of the eye errs towards false.
[[nodiscard]] bool faces_away(const NormalCone& cone, const Sphere& sphere, const glm::vec3& eye);

}  // namespace occlod
