// How large an object unit is on the screen at nodes of a front, and for how long that is so.
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
  ViewMotion motion;        // so far
  glm::vec3 center{0.0F};   // that it is counted from
};

// Finds anew for these nodes: Front::scales(), what largest_scale_px() of the view tells; whether they are outside or
// face away, as flags. Many at once, the same on every instruction set.
void weigh_nodes(Front& front, std::span<const Front::Index> which, const WeighingView& now);

// How large an object unit is on the screen at nodes as the hierarchy has them.

inline constexpr float scale_outside = -1.0F;
inline constexpr float scale_facing_away = -2.0F;  // inside the frustum

// In pixels per object unit, what largest_scale_px() of the view tells, or why nothing of the subtree is seen. Many at
// once, the same on every instruction set.
void weigh_splits(std::span<const SplitNode> nodes, const ObjectView& view, bool tests_cones,
                  std::span<float> scales_px);
// The same for nodes of a hierarchy; nothing is told where there is no_id. Throws Error when one is damaged.
void weigh_splits(const Hierarchy& hierarchy, std::span<const SplitId> splits, const ObjectView& view, bool tests_cones,
                  std::span<float> scales_px);

// What weighing a vector of nodes finds, on its way from vectors to a front.

// A bit for each lane, as hn::StoreMaskBits stores them.
struct LaneBits {
  std::array<std::uint8_t, 8> bytes{};  // at least, for any number of lanes

  [[nodiscard]] bool operator[](std::size_t lane) const noexcept {
    return (static_cast<std::uint32_t>(bytes[lane / 8]) >> (lane % 8) & 1U) != 0;
  }
};

// Has room for the vectors of every instruction set that Highway knows at a fixed width.
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
    // What is not seen has no priority whatever its faces look like.
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
