#include "world_box.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <limits>

#include "occlod/bounds.h"

namespace occlod::tool {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr WorldBox empty_box{glm::dvec3(infinity), glm::dvec3(-infinity)};

void grow(WorldBox& box, const Box& object_box, const glm::dmat4& object_to_world) {
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 point(object_to_world * glm::dvec4(corner(object_box, i), 1.0));
    box.low = glm::min(box.low, point);
    box.high = glm::max(box.high, point);
  }
}

}  // namespace

double WorldBox::radius() const { return glm::length(high - low) / 2.0; }

WorldBox world_box(std::span<const LoadedObject> objects) {
  WorldBox box = empty_box;
  for (const LoadedObject& object : objects) grow(box, object.hierarchy->box(), object.object_to_world);
  return box;
}

WorldBox world_box(std::span<const LoadedHlod> hlods) {
  WorldBox box = empty_box;
  for (const LoadedHlod& hlod : hlods) grow(box, hlod.hlod->data().box, hlod.object_to_world);
  return box;
}

}  // namespace occlod::tool
