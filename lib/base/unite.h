// Boxes around boxes.
#pragma once

#include <glm/common.hpp>

#include "occlod/math/bounds.h"

namespace occlod {

// The smallest box around both.
[[nodiscard]] inline Box unite(const Box& a, const Box& b) { return {glm::min(a.min, b.min), glm::max(a.max, b.max)}; }

}  // namespace occlod
