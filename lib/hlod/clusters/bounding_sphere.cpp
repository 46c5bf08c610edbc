#include "hlod/clusters/bounding_sphere.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace occlod::hlod {

Sphere sphere_around(std::span<const Sphere> spheres) {
  struct Farthest {
    double distance = -1.0;  // of the far end of a sphere
    const Sphere* sphere = nullptr;
  };
  const auto farthest = [&](const glm::dvec3& from) {
    Farthest far;
    for (const Sphere& s : spheres)
      if (const double d = glm::distance(from, glm::dvec3(s.center)) + static_cast<double>(s.radius); d > far.distance)
        far = {d, &s};
    return far;
  };
  glm::dvec3 least(std::numeric_limits<double>::infinity()), most(-least);
  for (const Sphere& s : spheres) {
    least = glm::min(least, glm::dvec3(s.center) - static_cast<double>(s.radius));
    most = glm::max(most, glm::dvec3(s.center) + static_cast<double>(s.radius));
  }
  glm::dvec3 center = 0.5 * (least + most), best = center;
  double best_radius = std::numeric_limits<double>::infinity();
  constexpr int steps = 8;
  for (int step = 0; step <= steps; ++step) {
    const Farthest far = farthest(center);
    if (far.distance < best_radius) {
      best_radius = far.distance;
      best = center;
    }
    const glm::dvec3 way = glm::dvec3(far.sphere->center) - center;
    const double length = glm::length(way);
    if (!(length > 0.0)) break;
    const glm::dvec3 far_end = center + way * (far.distance / length);
    center += (far_end - center) / static_cast<double>(step + 4);
  }
  Sphere result{glm::vec3(best), 0.0F};
  constexpr double slack = 1.0 + 1e-6;  // for the rounding of doubles
  const double radius = farthest(glm::dvec3(result.center)).distance * slack;
  constexpr float largest = std::numeric_limits<float>::max();
  result.radius = radius < static_cast<double>(largest) ? std::nextafter(static_cast<float>(radius), largest) : largest;
  return result;
}

}  // namespace occlod::hlod
