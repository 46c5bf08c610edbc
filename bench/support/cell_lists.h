// Lists of splits of the cells of a small grid, what its tree adds, and what changes from a cell to the next.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "cells/cell_divider.h"
#include "papers/id_lists.h"

namespace occlod::bench {

using paper::Ids;

// The cells of a square grid whose middles are in a street.
struct CellGrid {
  int side = 0;                           // a power of two
  std::vector<std::optional<Ids>> cells;  // row by row: the splits of those that are there
  std::uint32_t split_count = 0;

  [[nodiscard]] const std::optional<Ids>& at(int x, int y) const {
    return cells[static_cast<std::size_t>(y * side + x)];
  }
};
// Of a city of 8 blocks along each side, 197,000 triangles, at a pixel in images of 1024x1024 to six sides.
[[nodiscard]] CellGrid build_grid(int side);

// What all cells below each node have and no node above adds, in depth-first order, a quarter of the square after the
// other.
[[nodiscard]] std::vector<Ids> tree_additions(const CellGrid& grid);

// The tree as it is in files, of splits alone. The boxes of its leaves begin where the cells are in the grid.
[[nodiscard]] CellSubtree packed_tree(const CellGrid& grid);

struct Transition {
  glm::ivec2 from{0}, to{0};
  paper::Delta delta;
};
// Between cells that share a side, each once.
[[nodiscard]] std::vector<Transition> transitions_of(const CellGrid& grid);

}  // namespace occlod::bench
