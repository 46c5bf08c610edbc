// Finds how large an object unit is on the screen at nodes, and for how long that holds.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "occlod/hierarchy.h"
#include "occlod/view.h"
#include "refine/front.h"

namespace occlod {

struct WeighingView {
  const ObjectView& view;
  bool tests_cones = true;  // whether nodes may face away
  ViewMotion motion;        // motion so far
  glm::vec3 center{0.0F};   // center that motion is counted from, object space
};

// Updates Front::scales() of these nodes with the result of ObjectView::largest_scale_px(), and their flags for being
// outside and facing away. Many nodes are weighed at once, with the same result on every instruction set.
void weigh_nodes(Front& front, std::span<const Front::Index> which, const WeighingView& now);

// Results of weigh_splits() where nothing of the subtree is seen.
inline constexpr float scale_outside = -1.0F;
inline constexpr float scale_facing_away = -2.0F;  // inside the frustum

// Finds the results of ObjectView::largest_scale_px(), pixels per object unit, or why nothing of the subtree is seen.
// Many nodes are weighed at once, with the same result on every instruction set.
void weigh_splits(std::span<const SplitNode> nodes, const ObjectView& view, bool tests_cones,
                  std::span<float> scales_px);
// Does the same for nodes of a hierarchy, with no meaningful result for no_id. Throws Error when a node is damaged.
void weigh_splits(const Hierarchy& hierarchy, std::span<const SplitId> splits, const ObjectView& view, bool tests_cones,
                  std::span<float> scales_px);

// Holds one bit per lane, as hn::StoreMaskBits stores them.
struct LaneBits {
  std::array<std::uint8_t, 8> bytes{};  // enough for any number of lanes

  [[nodiscard]] bool operator[](std::size_t lane) const noexcept {
    return (static_cast<std::uint32_t>(bytes[lane / 8]) >> (lane % 8) & 1U) != 0;
  }
};

// Carries the results for one vector of nodes to a front. Has room for the vectors of every instruction set that
// Highway knows at a fixed width.
struct WeighedLanes {
  static constexpr std::size_t most = 16;

  alignas(64) std::array<float, most> scale_px, radius, per_motion, motion_limit, eye_distance_limit;
  LaneBits outside, facing_away;

  void give(std::size_t lane, Front& front, Front::Index k, const WeighingView& now) const {
    const bool out = outside[lane], away = facing_away[lane];
    front.set(k, Front::outside, out);
    front.set(k, Front::facing_away, away);
    BoundedValues& scales = front.scales();
    const float scale = out || away ? 0.0F : scale_px[lane];
    // What is not seen has priority 0 whatever its faces look like, so the priority expires when that changes.
    if ((scale > 0.0F) != (scales.value[k] > 0.0F)) front.priorities().forget(k);
    scales.put(k, scale, {radius[lane], per_motion[lane], motion_limit[lane], 0.0F, eye_distance_limit[lane]},
               now.motion);
  }
};

inline double tan_corner_angle(const ObjectView& view) {
  const double cos = view.cos_corner_angle();
  return std::sqrt(1.0 - cos * cos) / cos;
}

}  // namespace occlod
