// A camera as data: what scene files hold and what every report prints.
#pragma once

#include <glm/vec3.hpp>
#include <optional>

namespace occlod {

// Right-handed; a camera at `eye` looks at `target`, in perspective unless it has an orthographic height. World units;
// pixels are square.
struct Camera {
  glm::dvec3 eye{0.0, 0.0, 3.0};  // world space
  glm::dvec3 target{0.0};         // world space, not the eye
  glm::dvec3 up{0.0, 1.0, 0.0};   // of any length, not along the line of sight
  double fov_y_deg = 45.0;        // full vertical angle, in (0, 180); an orthographic camera ignores it
  int width = 1024;               // pixels, 1 to 16,384
  int height = 768;               // pixels, 1 to 16,384
  double near = 0.01;             // distance to the near plane, > 0
  double far = 100.0;             // distance to the far plane, > near
  // World units from the lower to the upper border of the image, > 0: all rays are parallel to the line of sight.
  std::optional<double> orthographic_height = std::nullopt;

  friend bool operator==(const Camera&, const Camera&) = default;
};

// The distance, world units, from which the camera sees all of a sphere of this radius (world units) in the middle of
// its image, with a fiftieth to spare; an orthographic camera is taken as if it were in perspective.
[[nodiscard]] double fitting_distance(const Camera& camera, double radius);

// The same camera with parallel rays, showing as much at the distance of its target.
[[nodiscard]] Camera orthographic(const Camera& camera);

}  // namespace occlod
