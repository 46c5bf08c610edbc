// One tree of all root cells.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "cells/cell_grid.h"
#include "cells/cell_subtree.h"

namespace occlod {

// Above root cells there are blocks of 2, 4, 8 ... of them to every side, above those a node for each region, above
// these one for all; nodes with a single child are left out. Calls take(i) for each root cell in turn. Memory: the sets
// of eight trees a level.
[[nodiscard]] CellSubtree join_roots(std::span<const RootCell> roots,
                                     const std::function<CellSubtree(std::size_t)>& take);

}  // namespace occlod
