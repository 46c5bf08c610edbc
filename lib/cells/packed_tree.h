// Trees of root cells in a tenth of the memory, until they are joined.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cells/cell_subtree.h"
#include "cells/vlod_format.h"

namespace occlod {

// Elements of the sets of a tree.
struct SetCounts {
  std::uint64_t splits = 0, candidates = 0, hidden = 0, used = 0, drawn = 0;
};

// The sets of a tree, coded: what all leaves share, and what some have.
struct PackedSets {
  std::vector<std::byte> shared, used;
  SetCounts counts;
};

struct PackedTree {
  CellSubtree tree;  // without its sets
  PackedSets sets;
};

[[nodiscard]] PackedTree pack(CellSubtree tree);
[[nodiscard]] CellSubtree unpack(PackedTree packed, const vlod::GlobalIds& ids);

// Of the same bytes in a file. Nothing, and what is wrong in `problem`, when they do not hold so many elements.
[[nodiscard]] std::optional<CellSets> unpack(std::span<const std::byte> shared, std::span<const std::byte> used,
                                             const SetCounts& counts, const vlod::GlobalIds& ids, std::string& problem);

}  // namespace occlod
