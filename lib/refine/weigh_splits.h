// How large an object unit is on the screen at nodes as the hierarchy has them.
#pragma once

#include <span>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/view/view.h"

namespace occlod {

inline constexpr float scale_outside = -1.0F;
inline constexpr float scale_facing_away = -2.0F;  // inside the frustum

// In pixels per object unit, what largest_scale_px() of the view tells, or why nothing of the subtree is seen. Many at
// once, the same on every instruction set.
void weigh_splits(std::span<const SplitNode> nodes, const ObjectView& view, bool tests_cones,
                  std::span<float> scales_px);
// The same for nodes of a hierarchy; nothing is told where there is no_id. Throws Error when one is damaged.
void weigh_splits(const Hierarchy& hierarchy, std::span<const SplitId> splits, const ObjectView& view, bool tests_cones,
                  std::span<float> scales_px);

}  // namespace occlod
