// The edges at which a mesh ends.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod::tiles {

// By vertex: the first vertex at the same position. O(n log n).
[[nodiscard]] std::vector<std::uint32_t> first_at_position(std::span<const glm::vec3> positions);

// An edge that one triangle uses, as it is wound.
struct BorderEdge {
  std::uint32_t from;
  std::uint32_t to;
  std::uint32_t triangle;
};

// Of positions, not of vertices: at seams between wedges there is no border. `first`: of first_at_position(). By
// triangle. O(n log n).
[[nodiscard]] std::vector<BorderEdge> border_edges(std::span<const Triangle> triangles,
                                                   std::span<const std::uint32_t> first);

// By vertex: the sum of the doubled area vectors of the triangles at its position; zero for all but the first there.
[[nodiscard]] std::vector<glm::dvec3> area_sums(std::span<const glm::vec3> positions,
                                                std::span<const Triangle> triangles,
                                                std::span<const std::uint32_t> first);

}  // namespace occlod::tiles
