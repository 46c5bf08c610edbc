// Clips one triangle in clip space, against the near plane and against the guard band, so that screen coordinates stay
// small; counts fragments from clipped areas.
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

// Exact arithmetic leaves at most eight corners after five planes. Rounding can make a degenerate polygon zigzag along
// a plane; even then, each cut adds at most half as many corners as the polygon has: 4, 6, 9, 13, 19.
inline constexpr std::size_t largest_clip_polygon = 19;

struct ClipPolygon {
  std::array<glm::dvec4, largest_clip_polygon> corners;
  std::size_t size = 0;
};

// Returns the part of the triangle with z >= -w, |x| <= guard.x * w and |y| <= guard.y * w. It has fewer than three
// corners when that part is empty, when nothing of the triangle can be inside the image or when a corner is not finite.
// A corner made on an edge depends only on that edge, whichever triangle it belongs to and whichever way it runs, so
// that clipped neighbours still share their edges.
[[nodiscard]] ClipPolygon clip_triangle(const std::array<glm::dvec4, 3>& triangle, const glm::dvec2& guard);

}  // namespace occlod::raster

namespace occlod {

// Counts triangles and fragments of a mesh in a view.
struct FragmentCount {
  double triangles = 0.0;
  double layers = 0.0;  // fragments per pixel of the image: 1 when triangles cover the image once

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

// Estimates the fragments of a mesh, and of its front faces, which occluders keep, from the areas of triangles in the
// image, clipped to it. Only every `step`-th triangle is measured and stands for `step` triangles; step >= 1. With
// `two_sided` all triangles are front faces. Triangles with corners that are not finite count, without fragments.
// O(triangles / step).
[[nodiscard]] MeshFragments count_fragments(std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                                            const ObjectView& view, bool two_sided, std::size_t step);

}  // namespace occlod
