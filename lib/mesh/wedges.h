// Normals of unit length.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "occlod/mesh.h"

namespace occlod {

// False for one that is zero or not finite. One of unit length but for rounding stays as it is, so that doing it again
// changes nothing.
inline bool normalize_in_place(glm::vec3& normal) {
  constexpr double rounding = 0x1p-21;  // of the squared length, as single precision leaves it
  const double squared = glm::dot(glm::dvec3(normal), glm::dvec3(normal));
  if (std::abs(squared - 1.0) <= rounding) return true;
  const double length = std::sqrt(squared);
  if (!(length > 0.0) || !std::isfinite(length)) return false;
  normal = glm::vec3(glm::dvec3(normal) / length);
  return true;
}

// Twice the area of a triangle along its normal.
inline glm::dvec3 area_vector(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 origin(a);
  return glm::cross(glm::dvec3(b) - origin, glm::dvec3(c) - origin);
}

// Instead of normals without a direction: that of the sum of the area vectors round a position, or +z where they cancel
// out.
inline glm::vec3 normal_along(const glm::dvec3& sum) {
  const double length = glm::length(sum);
  return length > 0.0 && std::isfinite(length) ? glm::vec3(sum / length) : glm::vec3(0, 0, 1);
}

// Gives the corners of a welded mesh their wedges.

// `mesh` has welded triangles, but still the vertices as read, with their attributes, without NaN; `read_corners` is
// the vertex as read at each corner of each triangle. Vertices that no triangle uses are dropped, the others keep their
// order. Corners of a vertex whose attributes and material are equal (+0 and -0 are) share a wedge; the first wedge of
// a vertex is that of the first triangle that uses it, the others follow in the order of their first use. Returns
// false, with `mesh` as it was, where ids cannot count the wedges. Expected O(n).
[[nodiscard]] bool form_wedges(TriangleMesh& mesh, std::vector<Triangle> read_corners);

}  // namespace occlod
