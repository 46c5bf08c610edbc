// The arithmetic of screen_bounds for many bounds at once, one to a lane: the same bits, with every instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "occlod/math/bounds.h"
#include "occlod/refine/visibility.h"
#include "occlod/view/view.h"

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
// Of no more than most_hull_points points each.
void find_screen_bounds(const BoundsView& view, std::span<const PointHull> hulls, BoundsOutput& output,
                        DiagonalsOutput& diagonals);
inline constexpr std::size_t most_hull_points = 32;

// Pixels that points fall into.
struct PointsOutput {
  PerBound<std::int32_t> x, y, on_screen;  // 0, 0 where they are not on the screen
  PerBound<float> nearness;
};
// At most bounds_batch_size points.
void find_pixels(const BoundsView& view, std::span<const glm::vec3> points, PointsOutput& output);

}  // namespace occlod
