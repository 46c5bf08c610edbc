// How far a picture is from the picture of the full mesh.
#pragma once

#include <cstddef>

#include "occlod/picture/picture.h"
#include "occlod/raster/item_buffer.h"
#include "occlod/view/view.h"

namespace occlod {

struct PictureDistance {
  // Root mean square depth difference over pixels covered by both, in pixels at that depth, each capped at 10.
  double depth_rms_px = 0.0;
  double silhouette_mismatch = 0.0;  // pixels covered by only one of the two, in percent of those the reference covers;
                                     // infinite when it covers none
  double psnr_y = 0.0;  // of luma (Rec. 601) between the two images, best shaded without wire, dB; infinite when equal
};

// Both buffers were drawn for `view`; images have the same size.
[[nodiscard]] PictureDistance compare_pictures(const View& view, const DepthBuffer& depth, const Image& image,
                                               const DepthBuffer& reference_depth, const Image& reference_image);

// Pixels of `expected` that `found` cannot explain if both show the same surface to within `allowed_px` pixels. A pixel
// is explained when its depth lies, give or take allowed_px pixels at that depth, between the nearest and the farthest
// that `found` has within allowed_px pixels around it; background is infinitely far. Pixels that something was wrongly
// hidden from are unexplained; silhouettes that moved by what is allowed are not. O(pixels).
[[nodiscard]] std::size_t count_unexplained_pixels(const View& view, const DepthBuffer& expected,
                                                   const DepthBuffer& found, double allowed_px);

}  // namespace occlod
