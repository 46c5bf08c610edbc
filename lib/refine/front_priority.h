// What the split of a node is worth by how its own faces are seen, and for how long.
#pragma once

#include "occlod/refine/refiner.h"
#include "refine/front.h"
#include "refine/importance.h"

namespace occlod {

struct FrontPriority {
  Importance::Value value;
  ErrorGrowth growth;
};

struct FrontView {
  const ObjectView& view;
  const Importance& importance;
  bool two_sided = false;
  float grazing_exponent = 0.0F;
  float steepness = 0.0F;  // twice the tangent of the angle of the image's corners
  glm::vec3 center{0.0F};  // that motion is counted from
};

// Of a star with no more than FrontStar::most_faces that is wholly inside the frustum, of a split with these errors.
[[nodiscard]] FrontPriority front_priority(const FrontStar& star, const SplitErrors& errors,
                                           const FrontView& front_view);

}  // namespace occlod
