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
  // Between the two images, best shaded without wire, dB; infinite when equal. Luma and both colour differences as in
  // JPEG: Rec. 601, full range.
  double psnr_y = 0.0;
  double psnr_cb = 0.0;
  double psnr_cr = 0.0;
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

// The largest distance in pixels that anything moved by between two depth images of one surface, in either direction of
// time: the largest over the pixels of both of the smallest a with which the pixel is explained by the other image, as
// above, but by what that has within floor(a) pixels. A silhouette that moved by 3 pixels gives 3. No more than
// most_px, as where one image lacks what the other has. O(pixels * the result).
[[nodiscard]] double largest_motion_px(const View& view, const DepthBuffer& one, const DepthBuffer& other,
                                       double most_px = 64.0);

// What a change of the mesh alone does to the picture: two meshes of one surface in the same view, as the cuts of two
// consecutive frames, both drawn with the later frame's camera.
struct Popping {
  double largest_px = 0.0;           // largest_motion_px()
  double rms_px = 0.0;               // as PictureDistance::depth_rms_px, against the later mesh
  double silhouette_mismatch = 0.0;  // as there
};

[[nodiscard]] Popping measure_popping(const View& view, const DepthBuffer& before, const DepthBuffer& after);

}  // namespace occlod
