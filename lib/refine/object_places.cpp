#include "refine/object_places.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

namespace occlod {

std::size_t splits_of(std::span<const RefineObject> objects) {
  std::vector<const Hierarchy*> hierarchies;
  for (const RefineObject& object : objects) hierarchies.push_back(object.hierarchy);
  std::sort(hierarchies.begin(), hierarchies.end());
  hierarchies.erase(std::unique(hierarchies.begin(), hierarchies.end()), hierarchies.end());
  std::size_t splits = 0;
  for (const Hierarchy* hierarchy : hierarchies) splits += hierarchy->split_count();
  return splits;
}

double extent_of(std::span<const RefineObject> objects) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const RefineObject& object : objects)
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 p(object.object_to_world * glm::dvec4(corner(object.hierarchy->box(), i), 1.0));
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  return glm::length(high - low);
}

double moved_by(const RefineObject& from, const RefineObject& to) {
  double moved = 0.0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 p(corner(from.hierarchy->box(), i), 1.0);
    moved = std::max(moved, glm::length((to.object_to_world - from.object_to_world) * p));
  }
  return moved;
}

}  // namespace occlod
