// The loops of the depth pyramid, with the widest vectors that the machine has.
#pragma once

#include <cstddef>
#include <cstdint>

#include "raster/bounds_batch.h"
#include "raster/depth_pyramid.h"

namespace occlod {

// Rows of every level are padded to a multiple of this many texels, so that vectors need no remainder.
inline constexpr int depth_row_texels = 32;

struct DepthLevelView {
  float* texels;  // row y at texels + y * stride
  int width, height;
  std::ptrdiff_t stride;
};

// Each texel of `level` in `changed` becomes the smallest of 2x2 texels of `below`; what lies beyond the last column or
// row is infinite, and stays so.
void reduce_depth(const DepthLevelView& below, const DepthLevelView& level, const PixelRect& changed);

// How many of `count` texels are <= limit.
[[nodiscard]] std::uint32_t count_not_nearer(const float* texels, int count, float limit);

// DepthPyramid::quick_verdict of the rectangles [0, count) of `bounds`. Verdicts are numbers of DepthPyramid::Verdict;
// those from count on mean nothing. Every rectangle, used or not, begins at no negative pixel.
void find_quick_verdicts(const DepthPyramid::Levels& levels, const BoundsOutput& bounds, std::size_t count,
                         PerBound<std::int32_t>& verdicts);

}  // namespace occlod
