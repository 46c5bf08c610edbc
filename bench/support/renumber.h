// The same hierarchy with its splits in another order, to see what the order is worth.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "occlod/hierarchy.h"

namespace occlod::bench {

// order[i] = the split that becomes split i: every split once, after its dependencies and its forest parent.
[[nodiscard]] Hierarchy renumbered(const Hierarchy& hierarchy, std::span<const SplitId> order);

// From coarse to fine, by the longest chain of dependencies above a split; at random where that is equal.
[[nodiscard]] std::vector<SplitId> shuffled_levels(const Hierarchy& hierarchy, std::uint64_t seed);

}  // namespace occlod::bench
