#include "occlod/view/view.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "occlod/core/error.h"

namespace occlod {
namespace {

[[noreturn]] void refuse(const char* place, const char* problem, const char* remedy) {
  throw Error({"camera", place, problem, remedy});
}

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void check(const Camera& camera) {
  if (!finite(camera.eye)) refuse("eye", "is not finite", "give three numbers");
  if (!finite(camera.target)) refuse("target", "is not finite", "give three numbers");
  if (!finite(camera.up)) refuse("up", "is not finite", "give three numbers");
  const glm::dvec3 forward = camera.target - camera.eye;
  if (!(glm::length(forward) > 0.0)) refuse("target", "is where the eye is", "move one of them");
  if (!(glm::length(glm::cross(glm::normalize(forward), camera.up)) > 1e-9 * glm::length(camera.up)))
    refuse("up", "points along the line of sight or is zero", "choose another up direction");
  if (!(camera.fov_y_deg > 0.0 && camera.fov_y_deg < 180.0))
    refuse("fov_y_deg", "is not between 0 and 180", "give the full vertical angle in degrees");
  if (camera.width < 1 || camera.height < 1 || camera.width > 16384 || camera.height > 16384)
    refuse("size", "is not between 1x1 and 16384x16384 pixels", "give another size");
  if (camera.orthographic_height && !(*camera.orthographic_height > 0.0 && std::isfinite(*camera.orthographic_height)))
    refuse("orthographic_height", "is not a length above 0", "give what the image shows from bottom to top");
  if (!(camera.near > 0.0 && camera.far > camera.near && std::isfinite(camera.far)))
    refuse("near, far", "are not 0 < near < far", "give other distances");
}

}  // namespace

View::View(const Camera& camera) : camera_(camera) {
  check(camera);
  direction_ = glm::normalize(camera.target - camera.eye);
  project();
  // Extreme distances and angles overflow.
  bool is_finite = std::isfinite(focal_length_px_);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) is_finite = is_finite && std::isfinite(world_to_clip_[column][row]);
  if (!is_finite) refuse("", "has distances or an angle that double precision cannot hold", "choose moderate ones");
}

void View::project() {
  const Camera& camera = camera_;
  const double aspect = static_cast<double>(camera.width) / camera.height;
  if (camera.orthographic_height) {
    const double half = *camera.orthographic_height / 2.0;
    world_to_clip_ = glm::ortho(-half * aspect, half * aspect, -half, half, camera.near, camera.far) *
                     glm::lookAt(camera.eye, camera.target, camera.up);
    focal_length_px_ = camera.height / *camera.orthographic_height;
    return;
  }
  const double half_angle = glm::radians(camera.fov_y_deg) / 2.0;
  world_to_clip_ = glm::perspective(2.0 * half_angle, aspect, camera.near, camera.far) *
                   glm::lookAt(camera.eye, camera.target, camera.up);
  focal_length_px_ = camera.height / 2.0 / std::tan(half_angle);
  const glm::dvec2 corner = glm::dvec2(aspect, 1.0) * std::tan(half_angle);
  cos_corner_angle_ = 1.0 / std::sqrt(1.0 + glm::dot(corner, corner));
}

}  // namespace occlod
