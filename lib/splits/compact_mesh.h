// Makes meshes of chosen triangles.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "occlod/mesh.h"

namespace occlod {

// Refers to the arrays of a mesh: positions by vertex, attributes by wedge, each of which may be empty.
struct WedgeArrays {
  std::span<const glm::vec3> positions;
  std::span<const glm::vec3> normals;
  std::span<const glm::u8vec4> colors;
  std::span<const glm::vec2> texture_coordinates;
};

// Makes a mesh of triangles without the vertices and wedges that none uses: vertices in the order of their first use,
// then extra wedges sorted by vertex. `wedges` names the attributes at the corners, which may be those of other
// vertices; all vertices are below `vertex_count`. Sets positions, attributes, extra_wedges, triangles and corners. O(n
// log n).
[[nodiscard]] TriangleMesh compact_mesh(const WedgeArrays& arrays, std::span<const Triangle> vertices,
                                        std::span<const Triangle> wedges, std::size_t vertex_count);

}  // namespace occlod
