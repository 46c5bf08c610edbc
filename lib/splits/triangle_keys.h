// Identifies triangles by their geometry, independent of vertex numbers.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "mesh/mesh_writers.h"
#include "occlod/mesh.h"

namespace occlod {

using TriangleKey =
    std::array<std::uint32_t, 9>;  // bits of the three corners, the smallest corner first, in winding order

// Returns the bits of the coordinate, with -0 mapped to 0.
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

// Identifies triangles by the attributes drawn at their corners, independent of wedge numbers.

// Holds one value per wedge, or none.
struct WedgeAttributes {
  std::span<const glm::vec3> positions, normals;
  std::span<const glm::u8vec4> colors;
  std::span<const glm::vec2> texture_coordinates;
  TextureOrigin texture_origin = TextureOrigin::bottom_left;
  int turns_of_v = 0;  // how often v becomes 1 - v before it is compared
};

// Removes from `restored` the attributes that `given` does not have. Returns false where `restored` lacks some of them.
// Where the texture origins differ, one of the two was once written with 1 - v, which rounds: whichever that was, 1 - v
// of the one and 1 - (1 - v) of the other are the same, as that difference is exact where 1 - v was rounded.
[[nodiscard]] inline bool keep_those_of(WedgeAttributes& given, WedgeAttributes& restored) {
  if (given.texture_origin != restored.texture_origin) {
    given.turns_of_v = 1;
    restored.turns_of_v = 2;
  }
  const auto keep = [](const auto& wanted, auto& found) {
    if (wanted.empty()) found = {};
    return wanted.empty() || !found.empty();
  };
  return keep(given.normals, restored.normals) && keep(given.colors, restored.colors) &&
         keep(given.texture_coordinates, restored.texture_coordinates);
}

// Identifies a triangle by its material and the bits at its corners, the smallest corner first, in winding order.
struct CornerKey {
  std::array<std::array<std::uint32_t, 9>, 3> corners{};
  MaterialId material = 0;
  friend bool operator==(const CornerKey&, const CornerKey&) = default;
  friend bool operator<(const CornerKey& a, const CornerKey& b) {
    return a.material != b.material ? a.material < b.material : a.corners < b.corners;
  }
};

[[nodiscard]] inline CornerKey corners_of(const Triangle& wedges, const WedgeAttributes& of, MaterialId material) {
  CornerKey key;
  key.material = material;
  for (std::size_t k = 0; k < 3; ++k) {
    const WedgeId w = wedges[static_cast<int>(k)];
    std::array<std::uint32_t, 9>& corner = key.corners[k];
    for (int i = 0; i < 3; ++i) corner[static_cast<std::size_t>(i)] = bits_of(of.positions[w][i]);
    for (int i = 0; i < 3 && !of.normals.empty(); ++i)
      corner[static_cast<std::size_t>(3 + i)] = bits_of(of.normals[w][i]);
    if (!of.colors.empty()) std::memcpy(&corner[6], &of.colors[w], sizeof(std::uint32_t));
    if (of.texture_coordinates.empty()) continue;
    glm::vec2 at = of.texture_coordinates[w];
    for (int i = 0; i < of.turns_of_v; ++i) at.y = from_other_origin(at.y);
    corner[7] = bits_of(at.x);
    corner[8] = bits_of(at.y);
  }
  std::rotate(key.corners.begin(), std::min_element(key.corners.begin(), key.corners.end()), key.corners.end());
  return key;
}

// Compares oriented boundaries exactly.

// Sums directed edges, or wound triangles, as an oriented chain: one and its reverse cancel, and one that repeats a
// corner vanishes. The sum is a fingerprint of 128 bits: equal chains have equal sums; different chains have equal sums
// with probability 2^-128.
class ChainSum {
 public:
  // Adds a triangle to a chain of triangles.
  void add(const Triangle& t) {
    if (t.x == t.y || t.y == t.z || t.z == t.x) return;
    const VertexId low = std::min({t.x, t.y, t.z}), high = std::max({t.x, t.y, t.z});
    const VertexId middle = t.x ^ t.y ^ t.z ^ low ^ high;
    const bool ascends = ((t.x > t.y) + (t.y > t.z) + (t.z > t.x)) == 1;
    add(scramble(std::uint64_t{low} << 32U | middle) + high, ascends);
  }
  // Adds an edge to a chain of edges.
  void add(VertexId from, VertexId to) {
    if (from == to) return;
    const std::uint64_t edge = std::uint64_t{std::min(from, to)} << 32U | std::max(from, to);
    add(edge, from < to);
  }
  void add(const ChainSum& other) {
    first_ += other.first_;
    second_ += other.second_;
  }
  friend bool operator==(const ChainSum&, const ChainSum&) = default;

 private:
  void add(std::uint64_t key, bool is_forward) {
    const std::uint64_t first = scramble(key), second = scramble(first ^ 0x9e3779b97f4a7c15ULL);
    first_ += is_forward ? first : 0 - first;
    second_ += is_forward ? second : 0 - second;
  }
  // Mixes bits as in Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators".
  static std::uint64_t scramble(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31U);
  }

  std::uint64_t first_ = 0, second_ = 0;
};

// Calls visit(from, to) for the three edges in winding order.
template <typename Visit>
void for_each_edge(const Triangle& t, const Visit& visit) {
  for (int k = 0; k < 3; ++k) visit(t[k], t[(k + 1) % 3]);
}

}  // namespace occlod
