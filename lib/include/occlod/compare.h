// Measures how far a picture is from the picture of the full mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "occlod/item_buffer.h"
#include "occlod/picture.h"
#include "occlod/view.h"

namespace occlod {

// Distances between two pictures; equal pictures have distances of 0 and infinite signal-to-noise ratios.
struct PictureDistance {
  // Root mean square depth difference over pixels covered by both, in pixels at that depth, each difference capped at
  // 10.
  double depth_rms_px = 0.0;
  double silhouette_mismatch = 0.0;  // pixels covered by only one of the two, in percent of those that the reference
                                     // covers; infinite when it covers none
  // Peak signal-to-noise ratio of luma, dB. Luma and colour differences are as in JPEG: Rec. 601, full range. The
  // ratios are infinite for equal pictures and most useful for images shaded without wire.
  double psnr_y = 0.0;
  double psnr_cb = 0.0;  // ratio of the blue difference, dB
  double psnr_cr = 0.0;  // ratio of the red difference, dB
};

// Compares a picture with its reference. Both buffers were drawn for `view`, and all four have its size. O(pixels).
[[nodiscard]] PictureDistance compare_pictures(const View& view, const DepthBuffer& depth, const Image& image,
                                               const DepthBuffer& reference_depth, const Image& reference_image);

// Counts the pixels of `expected` that `found` cannot explain if both show the same surface to within `allowed_px`
// pixels (>= 0). A pixel is explained when its depth lies, with a tolerance of allowed_px pixels at that depth, between
// the nearest and the farthest depth that `found` has within allowed_px pixels around it; background is infinitely far.
// So pixels where something was wrongly hidden count, and silhouettes that moved by at most allowed_px do not.
// O(pixels).
[[nodiscard]] std::size_t count_unexplained_pixels(const View& view, const DepthBuffer& expected,
                                                   const DepthBuffer& found, double allowed_px);

// Counts the pixels at which `found` lacks what `full` shows, when what `found` shows may have moved by allowed_px (>=
// 0) pixels and what is thinner than that may be missing. A pixel counts when all that `full` has within r pixels
// around it is nearer, by more than r pixels at its depth, than all that `found` has there; background is infinitely
// far. r is ceil(allowed_px) + 1, where the one more is for rounding to pixels, and 0 for allowed_px = 0. So of a wide
// surface that is missing, all but a rim of r pixels counts, and silhouettes that moved do not. O(pixels * allowed_px).
[[nodiscard]] std::size_t count_lost_pixels(const View& view, const DepthBuffer& full, const DepthBuffer& found,
                                            double allowed_px);

// Counts the pixels of `found` at which one sees through a gap, 1 or 2 pixels wide, between two parts of a surface that
// should meet. `full` shows the full mesh, which `found` should show to within allowed_px pixels (>= 0). A pixel counts
// when all of this holds; background is infinitely far:
//
// - It is farther, by more than allowed_px pixels at its depth, than everything that `full` has within max(2,
//   allowed_px) pixels.
// - `full` has no step in depth there, where silhouettes may have moved: along rows and columns its depth departs from
//   a straight line by at most 2 pixels. A step may be just outside the image, so pixels that near to the border do not
//   count.
// - Some pixel of `found` right beside it is as near as `full` is, to within allowed_px; this tells a gap from a
//   surface that is missing altogether.
//
// O(pixels * allowed_px).
[[nodiscard]] std::size_t count_crack_pixels(const View& view, const DepthBuffer& full, const DepthBuffer& found,
                                             double allowed_px);

// Returns the largest distance in pixels by which anything moved between two depth images of one surface; their order
// does not matter. For each pixel of either image, it is the smallest a with which the other image explains the pixel
// in the sense of count_unexplained_pixels(), looking within floor(a) pixels; the result is the largest of these. A
// silhouette that moved by 3 pixels gives 3. The result is at most max_px, for instance where one image lacks what the
// other has. O(pixels * result).
[[nodiscard]] double largest_motion_px(const View& view, const DepthBuffer& one, const DepthBuffer& other,
                                       double max_px = 64.0);

// How a change of the mesh alone changes the picture: compares the meshes of two consecutive frames, both drawn with
// the later frame's camera.
struct Popping {
  double largest_px = 0.0;           // largest_motion_px()
  double rms_px = 0.0;               // as PictureDistance::depth_rms_px, against the later mesh
  double silhouette_mismatch = 0.0;  // as PictureDistance::silhouette_mismatch, against the later mesh
};

// Measures popping between two buffers that were drawn for `view`. O(pixels * largest_px).
[[nodiscard]] Popping measure_popping(const View& view, const DepthBuffer& before, const DepthBuffer& after);

// The part of a texture that a pixel shows at its centre.
struct Texel {
  std::uint64_t surface = 0;   // differs between objects and materials; 0: no texture coordinates here
  glm::dvec2 coordinate{0.0};  // texture coordinate
  glm::dvec2 across{0.0};      // change of the coordinate from a pixel to the next one to the right
  glm::dvec2 down{0.0};        // change of the coordinate from a pixel to the next one below
};

// The texels of a picture.
struct TexelBuffer {
  int width = 0;              // pixels
  int height = 0;             // pixels
  std::vector<Texel> texels;  // width * height, rows from the top
};

// Finds the texels of what draw_items() drew of these objects in this view. `textures` has one entry for each object;
// images are not needed. O(pixels).
[[nodiscard]] TexelBuffer find_texels(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                                      std::span<const ObjectTexture> textures);

// Cap on the slip of a single pixel, in pixels.
inline constexpr double largest_slip_px = 10.0;

// Returns the root mean square slip of textures, in pixels, over the pixels that have texels in both pictures. The slip
// of a pixel is the distance of the texel of `shown` from the nearest position at which `full` shows it, interpolated
// between pixels by the coordinate's change, at most largest_slip_px. 0 when the pictures are equal; nothing when no
// pixel has texels in both. Pixels of `full` around which the coordinate does not change in both directions, up to
// rounding, do not determine where a texel should be, and do not count. Both pictures have the same size. O(pixels *
// slip^2).
[[nodiscard]] std::optional<double> texture_slip_px(const TexelBuffer& shown, const TexelBuffer& full);

}  // namespace occlod
