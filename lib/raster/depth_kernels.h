// Vectorised kernels of occlusion tests: screen bounds for many shapes at once, one per lane, and loops of the depth
// pyramid. Results have the same bits with every instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "occlod/bounds.h"
#include "occlod/view.h"
#include "occlod/visibility.h"
#include "raster/depth_pyramid.h"

namespace occlod {

// A multiple of the lane count of every instruction set.
inline constexpr std::size_t bounds_batch_size = 32;

// The parameters of a view of an object that all its bounds share.
struct BoundsView {
  // `nearness_scale` is a power of two by which nearness is multiplied.
  BoundsView(const View& view, const ObjectView& object, float nearness_scale = 1.0F);

  glm::dvec4 x, y, z, w;  // rows of object_to_clip
  glm::dvec2 size;        // pixels
  bool orthographic;
};

template <class T>
using PerBound = std::array<T, bounds_batch_size>;

// ScreenBounds, one per lane; the rectangle is empty where `trusted` is 0.
struct BoundsOutput {
  PerBound<std::int32_t> x0, y0, x1, y1, trusted;
  PerBound<float> largest_nearness;
};

// Computes screen_bounds() for at most bounds_batch_size shapes.
void find_screen_bounds(const BoundsView& view, std::span<const Sphere> spheres, BoundsOutput& output);
void find_screen_bounds(const BoundsView& view, std::span<const Box> boxes, BoundsOutput& output);
void find_screen_bounds(const BoundsView& view, std::span<const Cylinder> cylinders, BoundsOutput& output);
// The results of screen_diagonals(), one per lane, where `trusted` is not 0.
struct DiagonalsOutput {
  PerBound<double> sum_low, sum_high, difference_low, difference_high;
};
// Computes screen bounds and diagonals for at most bounds_batch_size hulls of at most max_hull_points points each.
void find_screen_bounds(const BoundsView& view, std::span<const PointHull> hulls, BoundsOutput& output,
                        DiagonalsOutput& diagonals);
inline constexpr std::size_t max_hull_points = 32;

// The pixels that contain points, one per lane.
struct PointsOutput {
  PerBound<std::int32_t> x, y, on_screen;  // 0, 0 for points that are not on the screen
  PerBound<float> nearness;
};
// Finds the pixels of at most bounds_batch_size points.
void find_pixels(const BoundsView& view, std::span<const glm::vec3> points, PointsOutput& output);

// Rows of every level are padded to a multiple of this many texels, so that vector loops need no remainder.
inline constexpr int depth_row_texels = 32;

template <class Texel>
struct DepthTexels {
  Texel* texels;  // row y at texels + y * stride
  int width, height;
  std::ptrdiff_t stride;
};
using DepthLevelView = DepthTexels<float>;

// Sets each texel of `level` in `changed` to the minimum of 2x2 texels of `below`. Texels beyond the last column or row
// are infinite and stay so.
void reduce_depth(const DepthLevelView& below, const DepthLevelView& level, const PixelRect& changed);

// Sets the first `columns` texels of each row of `level`, a multiple of depth_row_texels, to the minimum of 2x2 texels
// of `below`, which has twice the size and need not be padded.
void halve_depth(const DepthTexels<const float>& below, const DepthLevelView& level, int columns);

// Returns how many of `count` texels are <= limit.
[[nodiscard]] std::uint32_t count_not_nearer(const float* texels, int count, float limit);

// Computes DepthPyramid::quick_verdict() of the rectangles [0, count) of `bounds`. `verdicts` are numbers of
// DepthPyramid::Verdict; those from `count` on are undefined. No rectangle, used or not, begins at a negative pixel.
void find_quick_verdicts(const DepthPyramid::Levels& levels, const BoundsOutput& bounds, std::size_t count,
                         PerBound<std::int32_t>& verdicts);

}  // namespace occlod
