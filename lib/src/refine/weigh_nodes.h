// How large an object unit is on the screen at every node of a front.
#pragma once

#include <cstddef>
#include <span>

#include "front.h"
#include "occlod/view/view.h"

namespace occlod {

struct WeighedNodes {
  std::size_t outside = 0;      // the frustum
  std::size_t facing_away = 0;  // inside it
};

// Sets scale_px of each node to what scale_px_of() tells, many at once. O(nodes), in the order of memory.
WeighedNodes weigh_nodes(std::span<FrontNode> nodes, const ObjectView& view, bool tests_cones);

// In pixels per object unit, at most; 0 where nothing of the node's subtree is seen. Counts where it is not.
[[nodiscard]] float scale_px_of(const FrontNode& node, const ObjectView& view, bool tests_cones, WeighedNodes& counts);

// The same of splits as the hierarchy has them: in pixels per object unit, or why nothing of the subtree is seen.
inline constexpr float scale_outside = -1.0F;
inline constexpr float scale_facing_away = -2.0F;  // inside the frustum
void weigh_splits(std::span<const SplitNode> nodes, const ObjectView& view, bool tests_cones,
                  std::span<float> scales_px);

}  // namespace occlod
