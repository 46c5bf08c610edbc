#include "refine/view_motion.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "base/facing_slack.h"
#include "base/inverse_power_of_two.h"

namespace occlod {
namespace {

// From world space to the axes of the camera.
glm::dmat3 axes_of(const View& view) {
  const glm::dvec3 right = glm::normalize(glm::cross(view.direction(), view.camera().up));
  return glm::transpose(glm::dmat3(right, glm::cross(right, view.direction()), view.direction()));
}

// Cameras of a path are interpolated: what they share is the same but for rounding.
bool have_one_lens(const Camera& a, const Camera& b) {
  const auto alike = [](double x, double y) { return std::abs(x - y) <= 1e-13 * x; };
  return !a.orthographic_height && !b.orthographic_height && a.width == b.width && a.height == b.height &&
         alike(a.fov_y_deg, b.fov_y_deg) && alike(a.near, b.near) && alike(a.far, b.far);
}

// Of the largest singular value; the others are no smaller when all columns are as long and at right angles.
bool is_uniform(const glm::dmat3& m, double stretch) {
  const glm::dmat3 square = glm::transpose(m) * m;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(square[i][k] - (i == k ? stretch * stretch : 0.0)) <= 1e-9 * stretch * stretch)) return false;
  return true;
}

}  // namespace

std::optional<ViewMotion> motion_between(const PlacedView& from, const PlacedView& to, const glm::vec3& center) {
  const bool is_turned = glm::dmat3(from.object.object_to_eye()) != glm::dmat3(to.object.object_to_eye());
  if (!is_turned && from.view.camera() == to.view.camera() && from.object.object_to_eye() == to.object.object_to_eye())
    return ViewMotion{};
  if (!have_one_lens(from.view.camera(), to.view.camera())) return std::nullopt;
  const double stretch = to.object.largest_stretch();
  if (!is_uniform(glm::dmat3(to.object.object_to_eye()), stretch)) return std::nullopt;
  const glm::dmat3 axes_from = axes_of(from.view), axes_to = axes_of(to.view);
  glm::dmat3 change = axes_to - axes_from;
  if (is_turned) {  // the object itself
    const glm::dmat3 linear_from(from.object.object_to_eye()), linear_to(to.object.object_to_eye());
    const double stretch_from = from.object.largest_stretch();
    if (!is_uniform(linear_from, stretch_from) || !(std::abs(stretch_from - stretch) <= 1e-12 * stretch))
      return std::nullopt;
    change = (axes_to * linear_to - axes_from * linear_from) / stretch;
  }
  // Of a difference of two rotations, the Frobenius norm is sqrt 2 times as long as the largest change of a unit
  // vector.
  const double frobenius =
      glm::dot(change[0], change[0]) + glm::dot(change[1], change[1]) + glm::dot(change[2], change[2]);
  const glm::dvec4 at_center(center, 1.0);
  const glm::dvec3 seen_from = axes_from * (from.object.object_to_eye() * at_center);
  const glm::dvec3 seen_to = axes_to * (to.object.object_to_eye() * at_center);
  const glm::dvec3 eye_from(from.object.eye()), eye_to(to.object.eye());
  const double rounding =
      2.0 * eye_slack *
      static_cast<double>(largest_coordinate(from.object.eye()) + largest_coordinate(to.object.eye()));
  constexpr double up = 1.0 + 1e-6;
  const Camera &lens_from = from.view.camera(), &lens_to = to.view.camera();
  const double range = (std::abs(lens_from.near - lens_to.near) + std::abs(lens_from.far - lens_to.far)) / stretch;
  ViewMotion motion;
  motion.eye_distance = up * glm::distance(eye_from, eye_to) + rounding + range;
  motion.center_distance = up * glm::distance(seen_from, seen_to) / stretch + 1e-14 * glm::length(seen_to) + range;
  motion.rotation_rad = up * std::sqrt(0.5 * frobenius) + (is_turned ? 1e-8 : 1e-12);
  if (!(std::isfinite(motion.eye_distance) && std::isfinite(motion.center_distance) && motion.rotation_rad < 0.5))
    return std::nullopt;
  return motion;
}

}  // namespace occlod
