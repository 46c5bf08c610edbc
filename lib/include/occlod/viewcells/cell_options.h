// How space is divided into view cells, and how their cuts are chosen.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "occlod/viewcells/cell_builder.h"
#include "occlod/viewcells/cell_view.h"

namespace occlod {

// When a cell is divided that draws more than CellTreeOptions::most_triangles.
enum class CellDivision : std::uint32_t {
  halving,  // as in Chhugani and others 2003: if one of its parts, at least, draws less than half of what it draws
  gain      // if its parts draw, on average by volume, less than nine tenths of what it draws
};

// All that decides what is in a .vlod file, besides the objects.
struct CellTreeOptions {
  CellOptions cell = {};  // of each cell
  // The eye may be anywhere in these boxes, world space. Each is divided by itself; they may overlap.
  std::vector<CellBox> regions = {};
  double root_cell = 16.0;     // world units, > 0: a region is cut into equal boxes whose edges are no longer
  double smallest_cell = 1.0;  // world units, > 0: no edge is halved that would become shorter
  std::uint32_t levels = 10;   // of cells below those, at most; at most 32
  std::uint64_t most_triangles = 200'000;         // to draw: a cell that draws more is divided if `division` says so
  CellDivision division = CellDivision::halving;  // whether that is worth while
  // How far occluders may have moved, world units, >= 0; a quarter of smallest_cell unless it is given. See
  // CellOccluders. Unused where nothing is hidden.
  std::optional<double> occluder_motion = {};
};

}  // namespace occlod
