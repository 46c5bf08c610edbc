// How far the view of an object has moved: what bounds the change of everything that is seen in it.
#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <optional>

#include "occlod/view/view.h"

namespace occlod {

// Sums over frames that only grow.
struct Travel {
  double way = 0.0;   // of the eye, object units
  double sway = 0.0;  // of the middle of the object, seen from the eye, object units
  double turn = 0.0;  // of what is seen from the eye, radians

  // How far a point has moved as it is seen from the eye, at most: since two moments the difference. `radius`: its
  // largest distance from the eye; or, where that is less, its distance from the middle of the object, negative: an eye
  // that circles the object sees its middle stand still. Rounded.
  [[nodiscard]] float at(float radius) const noexcept {
    return static_cast<float>(radius < 0.0F ? sway : way) + static_cast<float>(turn) * std::abs(radius);
  }
};

// Parts of sums that rounding may add or take away between two calls.
constexpr float travel_rounding = 4e-7F;

struct TravelView {
  const View& view;
  const ObjectView& object;
};

// Between two views of one object with this middle, in its own space. Nothing when they differ in more than where the
// eye is and where it looks, when they are orthographic and differ at all, or when the object is stretched more in one
// direction than in another.
[[nodiscard]] std::optional<Travel> travel_between(const TravelView& from, const TravelView& to,
                                                   const glm::vec3& middle);

}  // namespace occlod
