// What the split of a node is worth by how its own faces are seen, and for how long.
#pragma once

#include "occlod/refine/refiner.h"
#include "priority/front.h"
#include "priority/importance.h"

namespace occlod {

struct FrontPriority {
  Importance::Value value;
  Drift drift;
};

struct FrontLook {
  const ObjectView& view;
  const Importance& importance;
  bool two_sided = false;
  float grazing_exponent = 0.0F;
  float steepness = 0.0F;  // twice the tangent of the angle of the image's corners
  glm::vec3 middle{0.0F};  // see Travel
};

// Of a star with no more than FrontStar::most_faces that is wholly inside the frustum, of a split with these errors.
[[nodiscard]] FrontPriority priority_of(const FrontStar& star, float error, float guaranteed_error,
                                        const FrontLook& look);

}  // namespace occlod
