#include "clipping.h"

#include <algorithm>
#include <limits>

namespace occlod::viewer {

ClipPlane clip_plane(const ClipSettings& settings, const Objects& objects) {
  if (settings.axis == ClipAxis::none) return std::nullopt;
  const int axis = static_cast<int>(settings.axis) - static_cast<int>(ClipAxis::x);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const PlacedObject& object : objects) {
    if (!object.shown) continue;
    for (int i = 0; i < 8; ++i) {
      const double at = (object.object_to_world * glm::dvec4(glm::dvec3(corner(box_of(object), i)), 1.0))[axis];
      low = std::min(low, at);
      high = std::max(high, at);
    }
  }
  if (!(low <= high)) return std::nullopt;
  const double sign = settings.flip ? 1.0 : -1.0;
  glm::dvec4 plane(0.0);
  plane[axis] = sign;
  plane.w = -sign * (low + settings.at * (high - low));
  return plane;
}

}  // namespace occlod::viewer
