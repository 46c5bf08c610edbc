#include "papers/first_node.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "occlod/base.h"

namespace occlod::paper {

std::vector<std::uint32_t> places_by_first_node(std::span<const Ids> added, std::uint32_t count) {
  std::vector<std::uint32_t> first(count, no_id);
  for (std::size_t n = added.size(); n-- > 0;)
    for (const std::uint32_t id : added[n]) first[id] = static_cast<std::uint32_t>(n);
  std::vector<std::uint32_t> order(count), places(count);
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return first[a] < first[b]; });
  for (std::uint32_t i = 0; i < count; ++i) places[order[i]] = i;
  return places;
}

}  // namespace occlod::paper
