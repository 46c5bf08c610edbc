// The arithmetic of screen_bounds for many bounds at once, one to a lane: the same bits, with every instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "occlod/math/bounds.h"
#include "occlod/view/view.h"

namespace occlod {

// A multiple of the lanes of every vector.
inline constexpr std::size_t bounds_batch_size = 32;

// What a view of an object adds to every bound.
struct BoundsView {
  BoundsView(const View& view, const ObjectView& object);

  glm::dvec4 x, y, z, w;  // rows of object_to_clip
  glm::dvec2 size;        // pixels
};

template <class T>
using PerBound = std::array<T, bounds_batch_size>;

// Of each kind the fields that it has: a sphere its center and radius, a cylinder all but `high`, a box low and high.
// Lanes that are not in use hold any numbers.
struct BoundsInput {
  std::size_t size = 0;
  std::array<PerBound<float>, 3> center{}, axis{};
  PerBound<float> radius{}, t_min{}, t_max{};
  std::array<PerBound<float>, 3> low{}, high{};

  void push(const Sphere& sphere);
  void push(const Box& box);
  void push(const Cylinder& cylinder);
};

// ScreenBounds in lanes; no rectangle where not trusted.
struct BoundsOutput {
  PerBound<std::int32_t> x0, y0, x1, y1, trusted;
  PerBound<float> nearest_inverse_depth;
};

// The bounds of input, all of one kind. Shape: Sphere, Box or Cylinder.
template <class Shape>
void find_screen_bounds(const BoundsView& view, const BoundsInput& input, BoundsOutput& output);

// The hull of the points, at least one, as bound 0.
void find_screen_bounds(const BoundsView& view, std::span<const glm::vec3> points, BoundsOutput& output);

}  // namespace occlod
