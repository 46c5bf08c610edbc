// Splits of one place belong together.
#pragma once

#include <cstdint>

#include "occlod/hlod/hlod.h"

namespace occlod::hlod {

// The least number of splits of node n, no less than `splits`, that applies all of a place or none. O(their number).
[[nodiscard]] inline std::uint32_t whole_splits(const Hlod& hlod, NodeId n, std::uint32_t splits) {
  if (!hlod.data().has_seams) return splits;
  const NodeWithin& within = hlod.data().within[n];
  const auto places = hlod.within(n).positions.subspan(within.bare);
  while (splits > 0 && splits < within.splits && places[splits] == places[splits - 1]) ++splits;
  return splits;
}

}  // namespace occlod::hlod
