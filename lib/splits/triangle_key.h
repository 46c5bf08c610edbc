// Triangles by what they cover, whatever their vertices are called.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

using TriangleKey =
    std::array<std::uint32_t, 9>;  // the bits of three corners, the smallest corner first, in winding order

// The bits of the number that the coordinate is: -0 is 0.
[[nodiscard]] inline std::uint32_t bits_of(float x) { return std::bit_cast<std::uint32_t>(x + 0.0F); }

[[nodiscard]] inline TriangleKey key_of(const Triangle& t, std::span<const glm::vec3> positions) {
  using Corner = std::array<std::uint32_t, 3>;
  std::array<Corner, 3> corners;
  for (int k = 0; k < 3; ++k) {
    const glm::vec3& p = positions[t[k]];
    corners[static_cast<std::size_t>(k)] = {bits_of(p.x), bits_of(p.y), bits_of(p.z)};
  }
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  TriangleKey key;
  for (std::size_t i = 0; i < 9; ++i) key[i] = corners[i / 3][i % 3];
  return key;
}

}  // namespace occlod
