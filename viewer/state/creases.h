// Finds the vertices of a mesh on creases, across which smooth shading must not blend.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::viewer {

inline constexpr double crease_unit_deg = 180.0 / 255.0;

// Returns, per vertex, the angle limit below which the faces around it fall apart, in units of crease_unit_deg. Two
// faces are connected when their normals differ across their shared edge by at most the limit. Closed fans fall apart
// where two edges are sharper, open ones where one is; an edge of three or more faces is as sharp as its sharpest pair.
// 0 means that the faces are level, or that there is at most one. O(triangles).
[[nodiscard]] std::vector<std::uint8_t> find_creases(std::span<const glm::vec3> positions,
                                                     std::span<const Triangle> triangles);

}  // namespace occlod::viewer
