// The cells of one level's octree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/large_vector.h"

namespace occlod::hlod {

// A run of leaf cells.
struct LeafRange {
  std::uint32_t first = 0;
  std::uint32_t end = 0;
};

// An octree whose cells are split until none holds too many items.
struct Cells {
  LargeVector<std::uint32_t> order;       // items along the Morton curve, equal codes by id
  std::vector<std::uint32_t> first_item;  // of each leaf cell, into `order`; then a sentinel
  std::vector<LeafRange> inner;           // the leaves below each inner cell, children before their parents; those of
                                          // a cell are consecutive
  [[nodiscard]] std::uint32_t leaf_count() const { return static_cast<std::uint32_t>(first_item.size() - 1); }
  [[nodiscard]] std::uint32_t item_count(std::uint32_t leaf) const { return first_item[leaf + 1] - first_item[leaf]; }
};

// Of items by their codes in an OctreeGrid. Where the finest cell still holds more than `most_items`, it is cut into
// runs of so many by id; items with equal unit_of[id], which are consecutive, stay together as far as they fit into one
// cell; empty: every item is a unit. O(n).
[[nodiscard]] Cells make_cells(std::span<const std::uint64_t> codes, std::uint32_t most_items,
                               std::span<const std::uint32_t> unit_of, unsigned threads);

}  // namespace occlod::hlod
