// A camera as data: what scene files hold and what every report prints.
#pragma once

#include <glm/vec3.hpp>
#include <optional>

namespace occlod {

// Right-handed; a camera at `eye` looks at `target`, in perspective unless it has an orthographic height. World units;
// pixels are square.
struct Camera {
  glm::dvec3 eye{0.0, 0.0, 3.0};
  glm::dvec3 target{0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  double fov_y_deg = 45.0;  // full vertical angle, in (0, 180); means nothing to an orthographic camera
  int width = 1024;         // pixels, >= 1
  int height = 768;         // pixels, >= 1
  double near = 0.01;       // distance to the near plane, > 0
  double far = 100.0;       // distance to the far plane, > near
  // From the lower to the upper border of the image, > 0: all rays are parallel to the line of sight.
  std::optional<double> orthographic_height = std::nullopt;

  friend bool operator==(const Camera&, const Camera&) = default;
};

// From how far away the camera sees all of a sphere of this radius in the middle of its image, with a fiftieth to
// spare; of an orthographic camera, were it in perspective.
[[nodiscard]] double fitting_distance(const Camera& camera, double radius);

// The same with parallel rays, showing as much at the distance of its target.
[[nodiscard]] Camera orthographic(const Camera& camera);

}  // namespace occlod
