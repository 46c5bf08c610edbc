// Colours biases (Charalambos 2006, figs 8 to 10).
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>

namespace occlod::tool {

// Returns the linear RGB of a bias in [0, 1]: blue where errors counted in full, through magenta to red where hardly
// any of a node was visible.
[[nodiscard]] inline glm::vec3 bias_color(float bias) {
  const float weaker = 1.0F - bias;
  return {std::min(2.0F * weaker, 1.0F), 0.02F, std::min(2.0F * bias, 1.0F)};
}

}  // namespace occlod::tool
