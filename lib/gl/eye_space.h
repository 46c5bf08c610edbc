// Objects relative to the eye, so that single precision is enough for the vertex shader. No OpenGL here.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "occlod/view/view.h"

namespace occlod::gl {

// From view space (x to the right, y up, z towards the viewer, the eye at the origin; world units) to clip space.
[[nodiscard]] glm::dmat4 view_to_clip(const View& view);

// One object's place before the eye: view = to_view * (position - eye) + offset. The difference is exact near the eye
// and off by 2^-24 of itself elsewhere, so a vertex moves by as little on the screen, wherever the object and its
// origin are; and it moves alike in every node that has it.
struct EyeSpace {
  EyeSpace(const View& view, const glm::dmat4& object_to_world);

  glm::vec3 eye{0.0F};        // object space, rounded
  glm::mat3 to_view{1.0F};    // from object to view space
  glm::vec3 offset{0.0F};     // view space: where the rounded eye is
  glm::dmat4 object_to_clip;  // in double precision
  bool mirrored = false;      // whether the placement turns triangles over
};

}  // namespace occlod::gl
