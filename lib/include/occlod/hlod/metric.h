// The error of a node on the screen.
#pragma once

#include <glm/vec3.hpp>

#include "occlod/hlod/hlod.h"

namespace occlod::hlod {

// An eye in object space.
struct ScreenScale {
  glm::dvec3 eye{0.0};            // its place
  double focal_length_px = 1.0;   // pixels that one object unit across the line of sight covers at distance 1
  double least_distance = 1e-30;  // > 0, object units: of the near plane
};

// Pixels that the node's error covers at most where the node is nearest to the eye: the larger of its own error at its
// box and its children's at its lod_box. No less than for any child of the node, seen from anywhere, so a front of
// nodes whose error is below a tolerance is legal as it is.
[[nodiscard]] double screen_error_px(const Node& node, const ScreenScale& scale);

// The same by the nearest point of the node's sphere, as published methods have it: coarser, and no less than for any
// child either.
[[nodiscard]] double sphere_error_px(const Node& node, const ScreenScale& scale);

}  // namespace occlod::hlod
