// The wedges of all faces of a hierarchy, from a collapse sequence.
#pragma once

#include <cstdint>
#include <span>

#include "splits/hierarchy_data.h"
#include "splits/simplify.h"
#include "splits/wedge_numbers.h"

namespace occlod {

// Fills in corners, corner_starts and base_corners of `data`, whose star records are written: that of split s starts at
// star_starts[s]. The result does not depend on the number of threads. O(n).
void write_corners(const CollapseSequence& sequence, const WedgeNumbers& numbers,
                   std::span<const std::uint32_t> star_starts, unsigned threads, HierarchyData& data);

}  // namespace occlod
