// How far a picture is from the picture of the full mesh.
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

// Distances between two pictures, 0 or infinite when they are equal.
struct PictureDistance {
  // Root mean square depth difference over pixels covered by both, in pixels at that depth, each capped at 10.
  double depth_rms_px = 0.0;
  double silhouette_mismatch = 0.0;  // pixels covered by only one of the two, in percent of those that the reference
                                     // covers; infinite when it covers none
  // Peak signal-to-noise ratios in dB of luma and both colour differences, as in JPEG: Rec. 601, full range. Infinite
  // when equal. Best between images shaded without wire.
  double psnr_y = 0.0;
  double psnr_cb = 0.0;  // of the blue difference
  double psnr_cr = 0.0;  // of the red difference
};

// Both buffers were drawn for `view`, and all four have its size. O(pixels).
[[nodiscard]] PictureDistance compare_pictures(const View& view, const DepthBuffer& depth, const Image& image,
                                               const DepthBuffer& reference_depth, const Image& reference_image);

// Counts the pixels of `expected` that `found` cannot explain if both show the same surface to within `allowed_px`
// pixels (>= 0). A pixel is explained when its depth lies, give or take allowed_px pixels at that depth, between the
// nearest and the farthest that `found` has within allowed_px pixels around it; background is infinitely far. So pixels
// where something was wrongly hidden count, and silhouettes that moved by no more than is allowed do not. O(pixels).
[[nodiscard]] std::size_t count_unexplained_pixels(const View& view, const DepthBuffer& expected,
                                                   const DepthBuffer& found, double allowed_px);

// Counts the pixels of `found` through which one looks where two parts of a surface do not meet: gaps that are 1 or 2
// pixels wide. Such a pixel is farther, by more than allowed_px pixels (>= 0) at that depth, than all that `full` has
// within max(2, allowed_px) pixels, and `full` has no step in depth there, where silhouettes may have moved: along rows
// and columns its depth departs from a straight line by 2 pixels at most. At the border of the image there may be one
// just outside, so pixels that near to it do not count. Some pixel of `found` right beside it is as near as `full` is,
// give or take allowed_px, which tells a gap from a surface that is not there at all. Background is infinitely far.
// `full`: of the full mesh, which `found` is to show to within allowed_px pixels. O(pixels * allowed_px).
[[nodiscard]] std::size_t count_crack_pixels(const View& view, const DepthBuffer& full, const DepthBuffer& found,
                                             double allowed_px);

// The largest distance in pixels by which anything moved between two depth images of one surface, whichever came first:
// the largest over the pixels of both of the smallest a with which the other image explains the pixel as above, looking
// within floor(a) pixels. A silhouette that moved by 3 pixels gives 3. At most max_px, for instance where one image
// lacks what the other has. O(pixels * result).
[[nodiscard]] double largest_motion_px(const View& view, const DepthBuffer& one, const DepthBuffer& other,
                                       double max_px = 64.0);

// How a change of the mesh alone changes the picture: the meshes of two consecutive frames, both drawn with the later
// frame's camera.
struct Popping {
  double largest_px = 0.0;           // largest_motion_px()
  double rms_px = 0.0;               // as PictureDistance::depth_rms_px, against the later mesh
  double silhouette_mismatch = 0.0;  // as there
};

// Both buffers were drawn for `view`. O(pixels * largest_px).
[[nodiscard]] Popping measure_popping(const View& view, const DepthBuffer& before, const DepthBuffer& after);

// How far textures are, in a picture, from where the picture of the full mesh has them.

// What part of a texture a pixel shows at its centre.
struct Texel {
  std::uint64_t surface = 0;   // objects and materials are told apart by it; 0: no texture coordinates here
  glm::dvec2 coordinate{0.0};  // of the texture
  glm::dvec2 across{0.0};      // by how much it changes from a pixel to the next one to the right
  glm::dvec2 down{0.0};        // to the next one below
};

// The texels of a picture.
struct TexelBuffer {
  int width = 0;              // pixels
  int height = 0;             // pixels
  std::vector<Texel> texels;  // width * height, rows from the top
};

// Of what draw_items() drew of these objects in this view. textures: one for each object; images are not needed.
// O(pixels).
[[nodiscard]] TexelBuffer find_texels(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                                      std::span<const ObjectTexture> textures);

// What a pixel's slip counts at most.
inline constexpr double largest_slip_px = 10.0;

// The root mean square over the pixels that have texels in both pictures: how far each texel of `shown` is from the
// nearest place at which `full` shows it, between pixels by its change across them, at most largest_slip_px. 0 where
// they are equal; none when no pixel has texels in both. Pixels of `full` around which the coordinate does not change
// in both directions, but for rounding, say nothing of where a texel should be, and do not count. Both have the same
// size. O(pixels * slip^2).
[[nodiscard]] std::optional<double> texture_slip_px(const TexelBuffer& shown, const TexelBuffer& full);

}  // namespace occlod
