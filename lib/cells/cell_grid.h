// How regions are cut into root cells, and cells into smaller ones.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "occlod/viewcells/cell_options.h"

namespace occlod {

struct RootCell {
  CellBox box;
  std::uint32_t region = 0;              // index in CellTreeOptions::regions
  std::array<std::uint32_t, 3> place{};  // in the grid of its region
};

// Of all regions in their order; within one along a Hilbert curve, so that those whose places differ only in the lowest
// n bits come one after the other, for any n. Throws Error when there are too many. O(n log n).
[[nodiscard]] std::vector<RootCell> root_cells(const CellTreeOptions& options);

// The box with every axis halved that is longer than 0.7 times the longest, and whose halves are no shorter than
// `smallest`; the box itself where there is none. Those with smaller coordinates first, x before y before z.
[[nodiscard]] std::vector<CellBox> parts_of(const CellBox& box, double smallest);

// Where the place x is along the curve through a cube of 2^21 to every side. (Skilling, Programming the Hilbert curve,
// 2004.)
[[nodiscard]] std::uint64_t hilbert_index(std::array<std::uint32_t, 3> x);

}  // namespace occlod
