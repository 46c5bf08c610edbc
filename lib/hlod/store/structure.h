// Chooses random fronts of an HLOD, and lists the patches that a front draws.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "occlod/hlod.h"

namespace occlod::hlod {

// Tells for each node whether it is refined. A front is legal when no node is refined without all its parents, and none
// of level 0.
using Refined = std::vector<char>;

// Returns a random legal front, refined with one probability everywhere or towards a random place. It depends on the
// state of `random` and nothing else. O(nodes).
[[nodiscard]] Refined random_front(const Hlod& hlod, std::mt19937_64& random);

// Gives for each node the number of its splits that are applied; 0 where it is drawn as it is.
using Cuts = std::vector<std::uint32_t>;

// Returns a random number of splits for half of the nodes that may be refined within: those that have splits, are not
// refined, and whose parents all are. O(nodes).
[[nodiscard]] Cuts random_cuts_of(const Hlod& hlod, const Refined& refined, std::mt19937_64& random);

// Calls visit(node, patch, place of the patch in HlodView::patches) for every patch that the front draws. O(nodes).
template <typename Visit>
void for_each_drawn(const Hlod& hlod, const Refined& refined, const Visit& visit) {
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    if (refined[n] != 0) continue;
    std::size_t place = hlod.node(n).first_patch;
    for (const Patch& patch : hlod.patches(n)) {
      if (patch.parent == no_id || refined[patch.parent] != 0) visit(n, patch, place);
      ++place;
    }
  }
}

}  // namespace occlod::hlod
