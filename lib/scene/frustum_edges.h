// The frustum of a view, to be drawn in another.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "occlod/view.h"

namespace occlod::picture {

// From the eye as far ahead as `length`, in world space: a pyramid, or a box where rays are parallel.
[[nodiscard]] std::vector<std::array<glm::dvec3, 2>> frustum_edges(const View& view, double length);

}  // namespace occlod::picture
