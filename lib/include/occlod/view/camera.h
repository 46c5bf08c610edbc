// A camera as data: what scene files hold and what every report prints.
#pragma once

#include <glm/vec3.hpp>

namespace occlod {

// Right-handed; a perspective camera at `eye` looks at `target`. World units; pixels are square.
struct Camera {
  glm::dvec3 eye{0.0, 0.0, 3.0};
  glm::dvec3 target{0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  double fov_y_deg = 45.0;  // full vertical angle, in (0, 180)
  int width = 1024;         // pixels, >= 1
  int height = 768;         // pixels, >= 1
  double near = 0.01;       // distance to the near plane, > 0
  double far = 100.0;       // distance to the far plane, > near

  friend bool operator==(const Camera&, const Camera&) = default;
};

// From how far away the camera sees all of a sphere of this radius in the middle of its image, with a fiftieth to
// spare.
[[nodiscard]] double fitting_distance(const Camera& camera, double radius);

}  // namespace occlod
