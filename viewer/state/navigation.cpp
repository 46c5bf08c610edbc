#include "navigation.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec4.hpp>

namespace occlod::viewer {
namespace {

constexpr double max_elevation_deg = 89.0;

struct Axes {
  glm::dvec3 right, up, ahead;  // unit; up and ahead as in the picture
  glm::dvec3 world_up;          // unit
};

Axes axes_of(const Camera& camera) {
  Axes axes;
  axes.world_up = glm::normalize(camera.up);
  axes.ahead = glm::normalize(camera.target - camera.eye);
  axes.right = glm::normalize(glm::cross(axes.ahead, axes.world_up));
  axes.up = glm::cross(axes.right, axes.ahead);
  return axes;
}

// Returns the direction turned right and up, kept from the poles.
glm::dvec3 turned(const Axes& axes, const glm::dvec3& direction, double right_deg, double up_deg) {
  const double elevation = glm::degrees(std::asin(std::clamp(glm::dot(direction, axes.world_up), -1.0, 1.0)));
  const double up = std::clamp(elevation + up_deg, -max_elevation_deg, max_elevation_deg) - elevation;
  glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), glm::radians(-right_deg), axes.world_up);
  turn = glm::rotate(turn, glm::radians(up), axes.right);
  return glm::dvec3(turn * glm::dvec4(direction, 0.0));
}

double half_tangent(const Camera& camera) { return std::tan(glm::radians(camera.fov_y_deg) / 2.0); }

// Returns the distance from which a perspective camera shows as much at the target.
double viewing_distance(const Camera& camera) {
  return camera.orthographic_height ? *camera.orthographic_height / (2.0 * half_tangent(camera))
                                    : glm::length(camera.target - camera.eye);
}

void shift(Camera& camera, const glm::dvec3& by) {
  camera.eye += by;
  camera.target += by;
}

}  // namespace

void orbit(Camera& camera, double right_deg, double up_deg) {
  const double distance = glm::length(camera.target - camera.eye);
  const Axes axes = axes_of(camera);
  camera.eye = camera.target - distance * turned(axes, axes.ahead, right_deg, up_deg);
}

void look_around(Camera& camera, double right_deg, double up_deg) {
  const double distance = viewing_distance(camera), behind = glm::length(camera.target - camera.eye) - distance;
  const Axes axes = axes_of(camera);
  const glm::dvec3 fixed = camera.eye + behind * axes.ahead, ahead = turned(axes, axes.ahead, right_deg, up_deg);
  camera.target = fixed + distance * ahead;
  camera.eye = fixed - behind * ahead;
}

void pan(Camera& camera, double right, double up) {
  const Axes axes = axes_of(camera);
  const double height = 2.0 * viewing_distance(camera) * half_tangent(camera);
  shift(camera, right * height * camera.width / camera.height * axes.right + up * height * axes.up);
}

void zoom(Camera& camera, double factor, const glm::dvec2& place) {
  const Ray ray = ray_through(camera, place);
  const double distance = glm::length(camera.target - camera.eye);
  const glm::dvec3 fixed = ray.origin + ray.direction * (distance / glm::dot(ray.direction, axes_of(camera).ahead));
  const glm::dvec3 target = fixed + factor * (camera.target - fixed);
  if (camera.orthographic_height) {
    camera.eye += target - camera.target;
    *camera.orthographic_height *= factor;
  } else {
    camera.eye = fixed + factor * (camera.eye - fixed);
  }
  camera.target = target;
}

void move(Camera& camera, const glm::dvec3& by) {
  const Axes axes = axes_of(camera);
  shift(camera, by.x * axes.right + by.y * axes.world_up + by.z * axes.ahead);
}

void move_level(Camera& camera, const glm::dvec3& by) {
  const Axes axes = axes_of(camera);
  shift(camera, by.x * axes.right + by.y * axes.world_up + by.z * glm::cross(axes.world_up, axes.right));
}

Ray ray_through(const Camera& camera, const glm::dvec2& place) {
  const Axes axes = axes_of(camera);
  const double half_height = camera.orthographic_height ? *camera.orthographic_height / 2.0 : half_tangent(camera);
  const double half_width = half_height * camera.width / camera.height;
  const glm::dvec3 aside = (2.0 * place.x - 1.0 - camera.principal_point.x) * half_width * axes.right +
                           (1.0 - 2.0 * place.y - camera.principal_point.y) * half_height * axes.up;
  return camera.orthographic_height ? Ray{camera.eye + aside, axes.ahead} : Ray{camera.eye, axes.ahead + aside};
}

void set_orthographic(Camera& camera, bool on, const SceneBounds& bounds) {
  if (on == camera.orthographic_height.has_value()) return;
  if (on) {
    camera = orthographic(camera);
  } else {
    camera.eye = camera.target - viewing_distance(camera) * axes_of(camera).ahead;
    camera.orthographic_height.reset();
  }
  hold(camera, bounds);
}

void frame(Camera& camera, const SceneBounds& bounds) {
  const glm::dvec3 ahead = glm::normalize(camera.target - camera.eye);
  camera.target = bounds.center;
  camera.eye = bounds.center - fitting_distance(camera, bounds.radius) * ahead;
  if (camera.orthographic_height) camera = orthographic(camera);
}

bool view_from(Camera& camera, std::string_view side, const SceneBounds& bounds) {
  const bool z_up = std::abs(camera.up.z) > std::abs(camera.up.y);
  const auto turn = [&](const glm::dvec3& d) { return z_up ? glm::dvec3(d.x, -d.z, d.y) : d; };
  constexpr double off_pole = 0.0175;  // one degree, so that the picture has an up direction
  glm::dvec3 from;
  if (side == "front") {
    from = {0.0, 0.0, 1.0};
  } else if (side == "back") {
    from = {0.0, 0.0, -1.0};
  } else if (side == "left") {
    from = {-1.0, 0.0, 0.0};
  } else if (side == "right") {
    from = {1.0, 0.0, 0.0};
  } else if (side == "top") {
    from = {0.0, 1.0, off_pole};
  } else if (side == "bottom") {
    from = {0.0, -1.0, off_pole};
  } else {
    return false;
  }
  camera.target = bounds.center;
  camera.eye = bounds.center + bounds.radius * turn(from);
  frame(camera, bounds);
  return true;
}

void hold(Camera& camera, const SceneBounds& bounds) {
  if (camera.orthographic_height) {
    const glm::dvec3 ahead = axes_of(camera).ahead;
    const double missing = 1.1 * bounds.radius - glm::dot(bounds.center - camera.eye, ahead);
    camera.eye -= std::max(missing, 0.0) * ahead;
  }
  fit_range(camera, bounds);
}

void fit_range(Camera& camera, const SceneBounds& bounds) {
  const glm::dvec3 to_center = bounds.center - camera.eye;
  camera.far = 1.01 * (glm::length(to_center) + bounds.radius);
  const double depth = glm::dot(to_center, axes_of(camera).ahead);  // less than the distance at the edge of the picture
  camera.near = std::max(0.99 * (depth - bounds.radius), camera.far * 1e-4);
}

}  // namespace occlod::viewer
