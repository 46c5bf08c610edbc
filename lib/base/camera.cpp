#include "occlod/view/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace occlod {

// The smaller side of the image decides.
double fitting_distance(const Camera& camera, double radius) {
  const double half_y = glm::radians(camera.fov_y_deg) / 2.0;
  const double half = std::atan(std::tan(half_y) * std::min(1.0, static_cast<double>(camera.width) / camera.height));
  return 1.02 * radius / std::sin(half);
}

Camera orthographic(const Camera& camera) {
  Camera result = camera;
  const double half_tangent = std::tan(glm::radians(camera.fov_y_deg) / 2.0);
  result.orthographic_height = 2.0 * glm::distance(camera.eye, camera.target) * half_tangent;
  return result;
}

}  // namespace occlod
