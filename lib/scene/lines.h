// Lines over a picture.
#pragma once

#include <glm/vec3.hpp>

#include "occlod/picture/picture.h"

namespace occlod::picture {

struct Pen {
  glm::vec3 color;  // linear
  float opacity = 1.0F;
  float width_px = 2.0F;
};

// A smooth line between two points of the world, over everything that the picture shows; what lies before the near
// plane of `view` is left out.
void draw_line(Image& image, const View& view, const glm::dvec3& from, const glm::dvec3& to, const Pen& pen);

}  // namespace occlod::picture
