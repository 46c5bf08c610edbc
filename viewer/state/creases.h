// Which vertices of a mesh lie on creases: smooth shading must not blend across those.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::viewer {

inline constexpr double crease_unit_deg = 180.0 / 255.0;

// By vertex, in units of crease_unit_deg: the angle limit below which the faces around it fall apart. Two faces hang
// together when their normals, across the edge they share, differ by at most the limit. Closed fans fall apart where
// two edges are sharper, open ones where one is; an edge of three or more faces is as sharp as its sharpest pair. 0:
// the faces are level, or there is one at most. O(triangles).
[[nodiscard]] std::vector<std::uint8_t> find_creases(std::span<const glm::vec3> positions,
                                                     std::span<const Triangle> triangles);

}  // namespace occlod::viewer
