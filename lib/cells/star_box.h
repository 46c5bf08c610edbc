// A box around what a split changes.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "base/unite.h"
#include "occlod/hierarchy/split_star.h"

namespace occlod {

// Around the faces that it inserts, object space.
[[nodiscard]] inline Box box_of(const SplitStar& star, std::span<const glm::vec3> positions) {
  Box box{positions[star.vertex()], positions[star.vertex()]};
  star.for_each_face([&](const Triangle& t) {
    for (int k = 0; k < 3; ++k) box = unite(box, {positions[t[k]], positions[t[k]]});
  });
  return box;
}

}  // namespace occlod
