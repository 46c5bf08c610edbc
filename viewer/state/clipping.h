// Places the clipping plane.
#pragma once

#include <glm/vec4.hpp>
#include <optional>

#include "objects.h"
#include "settings.h"

namespace occlod::viewer {

// A plane (a, b, c, d) in world space: points with a x + b y + c z + d >= 0 are drawn.
using ClipPlane = std::optional<glm::dvec4>;

// Returns the plane that the settings ask for, across the extent of the shown objects; nothing without an axis.
[[nodiscard]] ClipPlane clip_plane(const ClipSettings& settings, const Objects& objects);

[[nodiscard]] inline bool is_clipped(const ClipPlane& plane, const glm::dvec3& point) {
  return plane && plane->x * point.x + plane->y * point.y + plane->z * point.z + plane->w < 0.0;
}

}  // namespace occlod::viewer
