// Areas of what points surround in an image.
#pragma once

#include <glm/vec2.hpp>
#include <span>

namespace occlod::hlod {

// Pixels of the part of the convex hull of at most 8 points that lies in [0, size.x] x [0, size.y].
[[nodiscard]] double hull_area_inside(std::span<const glm::dvec2> points, const glm::dvec2& size);

}  // namespace occlod::hlod
