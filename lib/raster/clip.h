// Clips one triangle in clip space: against the near plane, and against the guard band so that screen coordinates stay
// small.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

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
