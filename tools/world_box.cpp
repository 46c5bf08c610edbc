#include "world_box.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <limits>

#include "occlod/math/bounds.h"

namespace occlod::tool {

double WorldBox::radius() const { return glm::length(high - low) / 2.0; }

WorldBox world_box(std::span<const LoadedObject> objects) {
  WorldBox box{glm::dvec3(std::numeric_limits<double>::infinity()),
               glm::dvec3(-std::numeric_limits<double>::infinity())};
  for (const LoadedObject& object : objects)
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 point(object.object_to_world * glm::dvec4(corner(object.hierarchy->box(), i), 1.0));
      box.low = glm::min(box.low, point);
      box.high = glm::max(box.high, point);
    }
  return box;
}

}  // namespace occlod::tool
