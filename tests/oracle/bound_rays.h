// Where rays are inside bounds, in double precision.
#pragma once

#include <glm/vec3.hpp>
#include <limits>

#include "occlod/visibility.h"

namespace occlod::test {

struct Ray {
  glm::dvec3 origin, direction;
};

// A range of ray parameters; empty where begin > end.
struct RayRange {
  double begin = -std::numeric_limits<double>::infinity();
  double end = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool empty() const { return begin > end; }
};

// Ray and bound in the same space. O(n^3) for a hull of n points.
[[nodiscard]] RayRange range_inside(const Ray& ray, const VisibilityQuery& bound);

}  // namespace occlod::test
