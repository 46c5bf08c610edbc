// How far every screen rectangle grows.
#pragma once

#include <limits>
#include <optional>

#include "occlod/view.h"
#include "occlod/visibility.h"
#include "raster/depth_pyramid.h"

namespace occlod {

// Pixels: the rasteriser moves corners by up to half of 1/256.
inline constexpr double bounds_slack_px = 1.0 / 256.0;
// Relative error of an entry of the single-precision object_to_clip and of the nearness that the rasteriser
// stores, with room to spare.
inline constexpr double bounds_rounding = 2.0 * std::numeric_limits<float>::epsilon();

// From a bound in object space to the pixels it may touch and its nearest depth.

struct ScreenBounds {
  PixelRect rect;  // every pixel that the bound touches, even in part; clipped to the image; empty when it lies beside
                   // the image
  float largest_nearness = 0.0F;  // >= that of every point of the bound; see DepthBuffer
};

// Nothing when no such rectangle can be trusted: the bound crosses the near plane, holds the eye or is not finite.
// Rounds outwards, so that what rounding in object_to_clip and in the rasteriser may add is inside. Spheres and
// cylinders are bounded by their true outlines, not by their corners.
[[nodiscard]] std::optional<ScreenBounds> screen_bounds(const View& view, const ObjectView& object,
                                                        const VisibilityQuery& query);

// The same for the diagonals: with the rectangle they leave an octagon around the outline. Infinite where they cannot
// be trusted.
[[nodiscard]] Diagonals screen_diagonals(const View& view, const ObjectView& object, const VisibilityQuery& query);

}  // namespace occlod
