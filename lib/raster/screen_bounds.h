// From a bound in object space to the pixels it may touch and its nearest depth.
#pragma once

#include <optional>

#include "occlod/refine/visibility.h"
#include "occlod/view/view.h"
#include "raster/depth_pyramid.h"

namespace occlod {

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
