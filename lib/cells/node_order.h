// An order of ids in which those of each cell are few runs: a sort instead of the tour of vLOD (2003).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace occlod {

// Of each id its place. `added`: of each node of a tree of cells, in depth-first order, what all cells below it have
// and no node above adds, each id once; ids < count.
//
// Sorted by the list of nodes that add an id, a list that goes on before one that ends; then by id. So ids that are in
// the same cells are one run. And an id that is in every cell that another is in comes before it, or has the smaller
// number and the same list: where both lists differ first, its node is farther up, or earlier, or the other's list has
// ended. A split that another depends on is such an id, so files of splits may be renumbered like this. O(n log n) in
// what all nodes add, typically.
[[nodiscard]] std::vector<std::uint32_t> places_by_nodes(std::span<const std::vector<std::uint32_t>> added,
                                                         std::uint32_t count);

}  // namespace occlod
