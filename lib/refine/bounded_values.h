// Numbers that change at bounded rates while the view moves, one for each node of a front.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "refine/view_motion.h"

namespace occlod {

// By how much a value may be off after the view has moved, and how far it may move before the value expires.
struct ErrorGrowth {
  float radius = 0.0F;  // of what the value depends on: see ViewMotion::displacement
  // After a displacement of d <= motion_limit the value is right to within a factor of 1 + per_motion * d, and a zero
  // is still zero.
  float per_motion = 0.0F;
  float motion_limit = -1.0F;  // < 0: it expires at once
  // The same for the distance that the eye has moved; both factors apply.
  float per_eye_distance = 0.0F;
  float eye_distance_limit = -1.0F;
};

// Values with the growth of their errors, and the sums of motion when they were computed.
struct BoundedValues {
  std::vector<float> value;  // >= 0, perhaps infinite
  // The factor to within which the value is right in this frame: 1 when it was computed in this frame, NaN when it has
  // expired.
  std::vector<float> error_factor;
  std::vector<float> radius, motion_then, per_motion, motion_limit;
  std::vector<float> eye_distance_then, per_eye_distance, eye_distance_limit;

  void add();
  // Moves the last one into its place.
  void remove(std::size_t k);
  void clear();
  void put(std::size_t k, float computed, const ErrorGrowth& growth, const ViewMotion& now);
  // It expires.
  void forget(std::size_t k);
  void forget_all();
  // Sets error_factor for the view that has moved so far. O(values), in vectors.
  void update(const ViewMotion& now);

  [[nodiscard]] bool is_exact(std::size_t k) const noexcept { return error_factor[k] == 1.0F; }
  [[nodiscard]] bool is_outdated(std::size_t k) const noexcept { return error_factor[k] != error_factor[k]; }
};

// Which nodes: by their flags, and by value * weight as far as it is known. An expired value may be anything.
struct Selection {
  std::uint16_t all = 0;  // of these flags
  std::uint16_t none = 0;
  float may_exceed = -1.0F;
  float may_be_below = std::numeric_limits<float>::infinity();  // infinity: any
};

// All that selecting reads. `weights`: empty = 1 each; where a weight is 0 so is the product.
struct BoundedProducts {
  const BoundedValues& values;
  std::span<const float> weights;
  std::span<const std::uint16_t> flags;
};

// Appends the indices of selected nodes, ascending. O(nodes), in vectors.
void select(const BoundedProducts& products, const Selection& selection, std::vector<std::uint32_t>& out);
[[nodiscard]] std::size_t count(const BoundedProducts& products, const Selection& selection);
// Of the nodes with these flags: the largest product is no smaller.
[[nodiscard]] float largest_at_least(const BoundedProducts& products, std::uint16_t all, std::uint16_t none);

}  // namespace occlod
