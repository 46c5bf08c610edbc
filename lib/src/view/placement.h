// Where an object may be placed.
#pragma once

#include <glm/mat4x4.hpp>

namespace occlod {

// Throws Error when `object_to_world` is not finite, not affine or cannot be inverted.
void require_placement(const glm::dmat4& object_to_world);

}  // namespace occlod
