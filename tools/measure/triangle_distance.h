// The nearest point of one triangle, safe for triangles without area.
#pragma once

#include <glm/vec3.hpp>

namespace occlod::measure {

// The point of the triangle a, b, c that is nearest to p. Exact up to rounding for every shape: corners come out
// exactly, and what comes out always lies on the triangle, also where its normal is lost in rounding.
[[nodiscard]] glm::dvec3 nearest_point(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                                       const glm::dvec3& c);

}  // namespace occlod::measure
