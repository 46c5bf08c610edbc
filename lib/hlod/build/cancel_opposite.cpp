#include "hlod/build/cancel_opposite.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <utility>

namespace occlod::hlod {
namespace {

// Of a triangle without regard to its winding.
std::uint64_t key_of(const Triangle& t) {
  const std::uint64_t low = std::min({t.x, t.y, t.z}), high = std::max({t.x, t.y, t.z});
  const std::uint64_t middle = std::uint64_t{t.x} + t.y + t.z - low - high;
  return low << 42U | middle << 21U | high;
}

// Whether the corners ascend when read round from the smallest.
bool is_even(const Triangle& t) { return ((t.x > t.y) + (t.y > t.z) + (t.z > t.x)) == 1; }

// Whether any two may have the same corners.
bool has_repeated(const std::vector<Triangle>& triangles) {
  constexpr std::uint64_t empty = ~std::uint64_t{0};  // no key: corners differ
  const std::size_t mask = std::bit_ceil(2 * triangles.size() + 2) - 1;
  thread_local std::vector<std::uint64_t> slots;
  slots.assign(mask + 1, empty);
  for (const Triangle& t : triangles) {
    const std::uint64_t key = key_of(t);
    std::size_t slot = (key * 0x9e3779b97f4a7c15ULL >> 24U) & mask;
    for (; slots[slot] != empty; slot = (slot + 1) & mask)
      if (slots[slot] == key) return true;
    slots[slot] = key;
  }
  return false;
}

}  // namespace

void cancel_opposite(std::vector<Triangle>& triangles) {
  std::vector<Triangle> none;
  cancel_opposite(triangles, none);
}

void cancel_opposite(std::vector<Triangle>& triangles, std::vector<Triangle>& corners) {
  if (!has_repeated(triangles)) return;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) sorted.emplace_back(key_of(triangles[i]), i);
  std::sort(sorted.begin(), sorted.end());
  std::vector<bool> goes(triangles.size(), false);
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    std::vector<std::uint32_t> same[2];
    for (end = begin; end < sorted.size() && sorted[end].first == sorted[begin].first; ++end)
      same[is_even(triangles[sorted[end].second]) ? 1 : 0].push_back(sorted[end].second);
    for (std::size_t i = 0; i < std::min(same[0].size(), same[1].size()); ++i)
      goes[same[0][i]] = goes[same[1][i]] = true;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (goes[i]) continue;
    triangles[kept] = triangles[i];
    if (!corners.empty()) corners[kept] = corners[i];
    ++kept;
  }
  triangles.resize(kept);
  if (!corners.empty()) corners.resize(kept);
}

}  // namespace occlod::hlod
