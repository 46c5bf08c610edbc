// Triangles by what is to be drawn at their corners, whatever their wedges are called.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "occlod/mesh/triangle_mesh.h"
#include "splits/triangle_key.h"

namespace occlod {

// One for each wedge, or empty.
struct CornerAttributes {
  std::span<const glm::vec3> positions, normals;
  std::span<const glm::u8vec4> colors;
  std::span<const glm::vec2> texture_coordinates;
};

// `restored` without those attributes that `given` does not have; nothing where it lacks some of them.
[[nodiscard]] inline bool keep_those_of(const CornerAttributes& given, CornerAttributes& restored) {
  const auto keep = [](const auto& wanted, auto& found) {
    if (wanted.empty()) found = {};
    return wanted.empty() || !found.empty();
  };
  return keep(given.normals, restored.normals) && keep(given.colors, restored.colors) &&
         keep(given.texture_coordinates, restored.texture_coordinates);
}

// A triangle by its material and the bits at its corners, the smallest corner first, in winding order.
struct CornerKey {
  std::array<std::array<std::uint32_t, 9>, 3> corners{};
  MaterialId material = 0;
  friend bool operator==(const CornerKey&, const CornerKey&) = default;
  friend bool operator<(const CornerKey& a, const CornerKey& b) {
    return a.material != b.material ? a.material < b.material : a.corners < b.corners;
  }
};

[[nodiscard]] inline CornerKey corners_of(const Triangle& wedges, const CornerAttributes& of, MaterialId material) {
  CornerKey key;
  key.material = material;
  for (std::size_t k = 0; k < 3; ++k) {
    const WedgeId w = wedges[static_cast<int>(k)];
    std::array<std::uint32_t, 9>& corner = key.corners[k];
    for (int i = 0; i < 3; ++i) corner[static_cast<std::size_t>(i)] = bits_of(of.positions[w][i]);
    for (int i = 0; i < 3 && !of.normals.empty(); ++i)
      corner[static_cast<std::size_t>(3 + i)] = bits_of(of.normals[w][i]);
    if (!of.colors.empty()) std::memcpy(&corner[6], &of.colors[w], sizeof(std::uint32_t));
    for (int i = 0; i < 2 && !of.texture_coordinates.empty(); ++i)
      corner[static_cast<std::size_t>(7 + i)] = bits_of(of.texture_coordinates[w][i]);
  }
  std::rotate(key.corners.begin(), std::min_element(key.corners.begin(), key.corners.end()), key.corners.end());
  return key;
}

}  // namespace occlod
