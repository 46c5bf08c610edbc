// Trees of cells as they are built: from the leaves up, each node with what its leaves have in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "occlod/viewcells/cell_tree.h"

namespace occlod {

// What the leaves of a tree apply and draw. By the numbers of vlod::GlobalIds; all ascending.
struct CellSets {
  std::vector<std::uint64_t> splits;      // that all leaves apply
  std::vector<std::uint64_t> used;        // that some leaf applies
  std::vector<std::uint64_t> candidates;  // that leaves below two of the root's children apply, but not all leaves
  std::vector<std::uint64_t> hidden;      // faces, owner << 32 | slot, that are hidden in some leaf and drawn in none
  std::vector<std::uint64_t> drawn;       // faces that are drawn in some leaf
};

// A tree whose root is not yet in a larger one: what the root adds depends on that, and is not yet known.
struct CellSubtree {
  std::vector<CellNode> nodes;  // `parent` and `end` count from the first, `payload` from the start of `payloads`;
                                // levels are not yet known, nor the payload of the first
  std::vector<std::byte> payloads;
  CellSets sets;
};

// Of a cell that is not divided, with the splits, hidden and drawn faces of its cut.
[[nodiscard]] CellSubtree leaf_of_tree(const CellNode& node, CellSets sets);
// One tree of several, at least two. O(size of their sets + bytes).
[[nodiscard]] CellSubtree join(std::vector<CellSubtree> parts);
// Of all nodes.
void set_levels(CellSubtree& tree);
// Nodes with levels and payloads, for good: the root adds what all leaves have.
void finish(CellSubtree& tree);

}  // namespace occlod
