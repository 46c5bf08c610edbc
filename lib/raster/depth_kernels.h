// The arithmetic of screen_bounds for many bounds at once, one to a lane: the same bits, with every instruction set.
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

// A multiple of the lanes of every vector.
inline constexpr std::size_t bounds_batch_size = 32;

// What a view of an object adds to every bound.
struct BoundsView {
  // `nearness_scale`: a power of two that nearness is multiplied by.
  BoundsView(const View& view, const ObjectView& object, float nearness_scale = 1.0F);

  glm::dvec4 x, y, z, w;  // rows of object_to_clip
  glm::dvec2 size;        // pixels
  bool orthographic;
};

template <class T>
using PerBound = std::array<T, bounds_batch_size>;

// ScreenBounds in lanes; no rectangle where not trusted.
struct BoundsOutput {
  PerBound<std::int32_t> x0, y0, x1, y1, trusted;
  PerBound<float> largest_nearness;
};

// At most bounds_batch_size shapes.
void find_screen_bounds(const BoundsView& view, std::span<const Sphere> spheres, BoundsOutput& output);
void find_screen_bounds(const BoundsView& view, std::span<const Box> boxes, BoundsOutput& output);
void find_screen_bounds(const BoundsView& view, std::span<const Cylinder> cylinders, BoundsOutput& output);
// As screen_diagonals() where trusted.
struct DiagonalsOutput {
  PerBound<double> sum_low, sum_high, difference_low, difference_high;
};
// Of no more than max_hull_points points each.
void find_screen_bounds(const BoundsView& view, std::span<const PointHull> hulls, BoundsOutput& output,
                        DiagonalsOutput& diagonals);
inline constexpr std::size_t max_hull_points = 32;

// Pixels that points fall into.
struct PointsOutput {
  PerBound<std::int32_t> x, y, on_screen;  // 0, 0 where they are not on the screen
  PerBound<float> nearness;
};
// At most bounds_batch_size points.
void find_pixels(const BoundsView& view, std::span<const glm::vec3> points, PointsOutput& output);

// The loops of the depth pyramid, with the widest vectors that the machine has.

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
