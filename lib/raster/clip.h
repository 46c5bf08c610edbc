// Clips one triangle in clip space: against the near plane, and against the guard band so that screen coordinates stay
// small.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "occlod/mesh.h"
#include "occlod/view.h"

namespace occlod::raster {

// Exact arithmetic would leave at most eight corners after five planes. Where rounding makes a degenerate polygon
// zigzag along a plane, cutting can still add only half of the corners that it has: 4, 6, 9, 13, 19.
inline constexpr std::size_t largest_clip_polygon = 19;

struct ClipPolygon {
  std::array<glm::dvec4, largest_clip_polygon> corners;
  std::size_t size = 0;
};

// The part of the triangle with z >= -w, |x| <= guard.x * w and |y| <= guard.y * w; fewer than three corners when there
// is none, when nothing of the triangle can be inside the image or when a corner is not finite. A corner made on an
// edge depends on that edge alone, whichever triangle it belongs to and whichever way it runs, so that clipped
// neighbours still share their edges.
[[nodiscard]] ClipPolygon clip_triangle(const std::array<glm::dvec4, 3>& triangle, const glm::dvec2& guard);

}  // namespace occlod::raster

namespace occlod {

// How many fragments a mesh has in a view: what drawing it costs besides its triangles.

// Of a mesh, or of its front faces: those that occluders keep.
struct FragmentCount {
  double triangles = 0.0;
  double layers = 0.0;  // fragments for each pixel of the image: 1 where triangles cover it once

  FragmentCount& operator+=(const FragmentCount& o) {
    triangles += o.triangles;
    layers += o.layers;
    return *this;
  }
};

struct MeshFragments {
  FragmentCount all;
  FragmentCount front;
};

// From the areas of triangles in the image, clipped to it. Of every `step`-th of them, each of which stands for `step`;
// step >= 1. `two_sided`: all are fronts. Not finite corners count as triangles without fragments. O(triangles / step).
[[nodiscard]] MeshFragments count_fragments(std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                                            const ObjectView& view, bool two_sided, std::size_t step);

}  // namespace occlod
