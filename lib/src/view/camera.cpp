#include "occlod/view/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>

namespace occlod {

// The smaller side of the image decides.
double fitting_distance(const Camera& camera, double radius) {
  const double half_y = glm::radians(camera.fov_y_deg) / 2.0;
  const double half = std::atan(std::tan(half_y) * std::min(1.0, static_cast<double>(camera.width) / camera.height));
  return 1.02 * radius / std::sin(half);
}

}  // namespace occlod
