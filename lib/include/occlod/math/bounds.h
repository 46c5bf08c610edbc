// Bounding volumes and normal cones: object space, object units, single precision rounded outwards.
#pragma once

#include <glm/vec3.hpp>
#include <span>

namespace occlod {

struct Sphere {
  glm::vec3 center{0.0F};
  float radius = 0.0F;  // >= 0
};

struct Box {
  glm::vec3 min{0.0F};
  glm::vec3 max{0.0F};  // min <= max in every axis
};

// A capped cylinder around the line center + t * axis, t in [t_min, t_max].
struct Cylinder {
  glm::vec3 center{0.0F};
  float radius = 0.0F;
  glm::vec3 axis{0.0F, 0.0F, 1.0F};  // unit length
  float t_min = 0.0F;
  float t_max = 0.0F;
};

// A cone of directions: all unit n with dot(n, axis) >= cos_angle. cos_angle <= 0 means "no cone":
// it promises nothing and never culls.
struct NormalCone {
  glm::vec3 axis{0.0F, 0.0F, 1.0F};  // unit length
  float cos_angle = -1.0F;

  [[nodiscard]] bool culls() const noexcept { return cos_angle > 0.0F; }
};

// The smallest axis-aligned box around `points` (at least one point).
[[nodiscard]] Box bounding_box(std::span<const glm::vec3> points);

// The corners of a box, x fastest: corner i has max.x iff bit 0 of i, max.y iff bit 1, max.z iff bit 2.
[[nodiscard]] glm::vec3 corner(const Box& box, int i);

// True iff every point of the surface inside `sphere`, with normals inside `cone`, faces away from
// an eye at `eye`, or at what was rounded to it: no front face of it can be seen. Rounding errs towards false.
[[nodiscard]] bool faces_away(const NormalCone& cone, const Sphere& sphere, const glm::vec3& eye);

}  // namespace occlod
