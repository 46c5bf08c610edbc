// How far the view of an object has moved: what bounds the change of everything that is seen in it.
#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <optional>

#include "occlod/view/view.h"

namespace occlod {

// Sums over frames: they only grow.
struct ViewMotion {
  double eye_distance = 0.0;     // that the eye has moved in object space
  double center_distance = 0.0;  // that the object's center has moved relative to the camera, object units
  double rotation_rad = 0.0;     // of the object's axes relative to the camera's

  // An upper bound of how far a point has moved relative to the camera; between two frames, their difference. `radius`
  // is the point's largest distance from the eye; or, where that is smaller, its distance from the object's center,
  // negated: for a camera that orbits the object, the center does not move. Rounded.
  [[nodiscard]] float displacement(float radius) const noexcept {
    return static_cast<float>(radius < 0.0F ? center_distance : eye_distance) +
           static_cast<float>(rotation_rad) * std::abs(radius);
  }
};

// Relative error of these sums by rounding, between two calls.
constexpr float motion_rounding = 4e-7F;

struct PlacedView {
  const View& view;
  const ObjectView& object;
};

// Between two views of one object with this center, in object space; it may have been moved and turned in between.
// Nothing when they differ in more than where the eye is, where it looks and where the object is, when they are
// orthographic and differ at all, or when the object is stretched more in one direction than in another.
[[nodiscard]] std::optional<ViewMotion> motion_between(const PlacedView& from, const PlacedView& to,
                                                       const glm::vec3& center);

}  // namespace occlod
