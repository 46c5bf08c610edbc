// Makes the frustum of a view as lines that can be drawn in another view.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "occlod/view.h"

namespace occlod::picture {

// Returns the edges from the eye to `length` ahead, in world space: a pyramid, or a box for parallel projection.
[[nodiscard]] std::vector<std::array<glm::dvec3, 2>> frustum_edges(const View& view, double length);

}  // namespace occlod::picture
