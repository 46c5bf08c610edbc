// Oriented boundaries, compared exactly.
#pragma once

#include <algorithm>
#include <cstdint>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// The sum of directed edges, or of wound triangles, as an oriented chain: one and its reverse cancel, what repeats a
// corner vanishes. As a fingerprint of 128 bits: equal chains have equal sums, others differ but for one chance in
// 2^128.
class ChainSum {
 public:
  // A triangle, in a chain of triangles.
  void add(const Triangle& t) {
    if (t.x == t.y || t.y == t.z || t.z == t.x) return;
    const VertexId low = std::min({t.x, t.y, t.z}), high = std::max({t.x, t.y, t.z});
    const VertexId middle = t.x ^ t.y ^ t.z ^ low ^ high;
    const bool ascends = ((t.x > t.y) + (t.y > t.z) + (t.z > t.x)) == 1;
    add(scramble(std::uint64_t{low} << 32U | middle) + high, ascends);
  }
  // An edge, in a chain of edges.
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
  // Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators".
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
