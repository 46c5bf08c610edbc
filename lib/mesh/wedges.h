// Normals of unit length, and the wedges of a mesh.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string_view>
#include <vector>

#include "occlod/mesh.h"

namespace occlod {

// Names in LeftOut the texture coordinates that become (0, 0).
inline constexpr std::string_view not_finite_coordinates = "texture coordinates that are not finite";

// Scales a normal to unit length. Returns false for one that is zero or not finite. One that has unit length up to
// rounding keeps its bits, so that repeating the call changes nothing.
inline bool normalize_in_place(glm::vec3& normal) {
  constexpr double rounding = 0x1p-21;  // error of the squared length that single precision leaves
  const double squared = glm::dot(glm::dvec3(normal), glm::dvec3(normal));
  if (std::abs(squared - 1.0) <= rounding) return true;
  const double length = std::sqrt(squared);
  if (!(length > 0.0) || !std::isfinite(length)) return false;
  normal = glm::vec3(glm::dvec3(normal) / length);
  return true;
}

// Returns a vector along a triangle's normal whose length is twice the triangle's area.
inline glm::dvec3 area_vector(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 origin(a);
  return glm::cross(glm::dvec3(b) - origin, glm::dvec3(c) - origin);
}

// Returns a replacement for a normal without a direction: the direction of `sum`, the sum of the area vectors around a
// position, or +z when they cancel out.
inline glm::vec3 normal_along(const glm::dvec3& sum) {
  const double length = glm::length(sum);
  return length > 0.0 && std::isfinite(length) ? glm::vec3(sum / length) : glm::vec3(0, 0, 1);
}

// Gives the corners of a welded mesh their wedges. `mesh` has welded triangles, but still the vertices as read, with
// their attributes, without NaN; `read_corners` has the vertex as read at each corner of each triangle. Vertices that
// no triangle uses are dropped; the others keep their order. Corners of a vertex whose attributes and material are
// equal (+0 and -0 are equal) share a wedge; the first wedge of a vertex is that of the first triangle that uses it,
// the others follow in the order of their first use. Returns false, with `mesh` as it was, when there are not enough
// ids for the wedges. Expected O(n).
[[nodiscard]] bool form_wedges(TriangleMesh& mesh, std::vector<Triangle> read_corners);

// Returns a cleaned mesh with wedges formed anew, so that all triangles that use one have the same feature, too.
// Vertices keep their order. Throws Error when there are not enough ids for the wedges. Expected O(n log n).
[[nodiscard]] TriangleMesh part_features(TriangleMesh mesh);

// Returns the feature of each wedge of such a mesh; empty when triangles name none. O(n).
[[nodiscard]] std::vector<FeatureId> wedge_features(const TriangleMesh& mesh);

}  // namespace occlod
