// The nearest point of one triangle, safe for triangles without area.
#pragma once

#include <glm/vec3.hpp>

namespace occlod::measure {

// A point of a triangle, and how much each of its corners counts there: at least 0, 1 together.
struct TrianglePoint {
  glm::dvec3 point{0.0};
  glm::dvec3 weights{1.0, 0.0, 0.0};
};

// The point of the triangle a, b, c that is nearest to p. Exact up to rounding for every shape: corners come out
// exactly, and what comes out always lies on the triangle, also where its normal is lost in rounding.
[[nodiscard]] TrianglePoint nearest_on_triangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                                                const glm::dvec3& c);
[[nodiscard]] glm::dvec3 nearest_point(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                                       const glm::dvec3& c);

}  // namespace occlod::measure
