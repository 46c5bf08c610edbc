// Bounds in object space on the screen: the pixels that they may touch and their nearest depth.
#pragma once

#include <limits>
#include <optional>

#include "occlod/view.h"
#include "occlod/visibility.h"
#include "raster/depth_pyramid.h"

namespace occlod {

// Every screen rectangle grows by this many pixels: the rasteriser moves corners by up to half of 1/256 pixel.
inline constexpr double bounds_slack_px = 1.0 / 256.0;
// Bound on the relative error of an entry of the single-precision object_to_clip and of the nearness that the
// rasteriser stores.
inline constexpr double bounds_rounding = 2.0 * std::numeric_limits<float>::epsilon();

struct ScreenBounds {
  PixelRect rect;  // contains every pixel that the bound touches, even in part; clipped to the image; empty when the
                   // bound is beside the image
  float largest_nearness = 0.0F;  // at least that of every point of the bound; see DepthBuffer
};

// Returns nothing when no rectangle can be trusted: the bound crosses the near plane, contains the eye or is not
// finite. Rounds outwards, so that rounding in object_to_clip and in the rasteriser is covered. Spheres and cylinders
// are bounded by their true outlines, not by their corners.
[[nodiscard]] std::optional<ScreenBounds> screen_bounds(const View& view, const ObjectView& object,
                                                        const VisibilityQuery& query);

// Returns the diagonals of a bound, which leave an octagon around the outline when they cut the rectangle of
// screen_bounds(). Rounds outwards; infinite where they cannot be trusted.
[[nodiscard]] Diagonals screen_diagonals(const View& view, const ObjectView& object, const VisibilityQuery& query);

}  // namespace occlod
