// How far every screen rectangle grows.
#pragma once

#include <limits>

namespace occlod {

// Pixels: the rasteriser moves corners by up to half of 1/256.
inline constexpr double bounds_slack_px = 1.0 / 256.0;
// Relative error of an entry of the single-precision object_to_clip and of the nearness that the rasteriser
// stores, with room to spare.
inline constexpr double bounds_rounding = 2.0 * std::numeric_limits<float>::epsilon();

}  // namespace occlod
