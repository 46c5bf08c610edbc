// Finds the nearest point of one triangle, even of one without area.
#pragma once

#include <glm/vec3.hpp>

namespace occlod::measure {

// Holds a point of a triangle with the weights of its corners, which are at least 0 and sum to 1.
struct TrianglePoint {
  glm::dvec3 point{0.0};
  glm::dvec3 weights{1.0, 0.0, 0.0};
};

// Returns the point of the triangle a, b, c that is nearest to p. It is exact up to rounding for every shape: corners
// are exact, and the result always lies on the triangle, even when its normal is lost in rounding.
[[nodiscard]] TrianglePoint nearest_on_triangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                                                const glm::dvec3& c);
[[nodiscard]] glm::dvec3 nearest_point(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                                       const glm::dvec3& c);

}  // namespace occlod::measure
