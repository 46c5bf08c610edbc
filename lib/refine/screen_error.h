// Measures the error that a split leaves on the screen while it is not applied.
#pragma once

#include <algorithm>
#include <cmath>

#include "occlod/hierarchy.h"

namespace occlod {

// Holds the errors of a split, object units. Both are saturated, since their parts are.
struct SplitErrors {
  float mean = 0.0F;        // quadric and attribute error together, about a root mean square
  float guaranteed = 0.0F;  // larger of the guaranteed error and the attribute error
};
[[nodiscard]] inline SplitErrors errors_of(const Hierarchy& hierarchy, SplitId s, bool with_attributes) noexcept {
  const SplitNode& node = hierarchy.node(s);
  const float slip = with_attributes ? hierarchy.attribute_error(s) : 0.0F;
  if (slip == 0.0F) return {node.error, node.guaranteed_error};
  return {std::sqrt(node.error * node.error + slip * slip), std::max(node.guaranteed_error, slip)};
}

// Holds upper bounds of errors, pixels.
struct ScreenError {
  float quadric_px = 0.0F;
  float guaranteed_px = 0.0F;

  ScreenError() = default;
  ScreenError(float error, float guaranteed_error, float scale_px)
      : quadric_px(in_pixels(error, scale_px)), guaranteed_px(in_pixels(guaranteed_error, scale_px)) {}
  ScreenError(const SplitErrors& errors, float scale_px) : ScreenError(errors.mean, errors.guaranteed, scale_px) {}
  // Returns the error in pixels; no error stays 0 even at an infinite scale.
  static float in_pixels(float error, float scale_px) { return error > 0.0F ? error * scale_px : 0.0F; }
  [[nodiscard]] bool includes(const ScreenError& o) const {
    return o.quadric_px <= quadric_px && o.guaranteed_px <= guaranteed_px;
  }
  void include(const ScreenError& o) {
    quadric_px = std::max(quadric_px, o.quadric_px);
    guaranteed_px = std::max(guaranteed_px, o.guaranteed_px);
  }
  // Returns whether the error is small enough to be left as it is. A tolerance of 0 tolerates nothing.
  [[nodiscard]] bool is_within(double tolerance_px) const {
    return tolerance_px > 0.0 && guaranteed_px <= static_cast<float>(tolerance_px);
  }
};

}  // namespace occlod
