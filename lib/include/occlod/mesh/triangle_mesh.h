// An indexed triangle mesh: what readers and generators make and what hierarchies are built from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "occlod/core/ids.h"

namespace occlod {

using Triangle = glm::u32vec3;  // three vertex ids, counter-clockwise seen from outside

// Meshes with larger coordinates are refused: bounds and errors reach a few times the diagonal, and are floats.
inline constexpr float farthest_coordinate = 1.5e37F;

// Plain indexed arrays. Valid when every index is in range and every optional array is empty or has one entry per
// vertex; clean() makes it so.
struct TriangleMesh {
  std::vector<glm::vec3> positions;  // object space, object units
  std::vector<glm::vec3> normals;    // unit length; empty or one per vertex
  std::vector<glm::u8vec4> colors;   // sRGB and alpha; empty or one per vertex
  std::vector<Triangle> triangles;   // every index < positions.size()

  // Number of positions.
  [[nodiscard]] std::size_t vertex_count() const noexcept { return positions.size(); }
  // Number of triangles.
  [[nodiscard]] std::size_t triangle_count() const noexcept { return triangles.size(); }
};

}  // namespace occlod
