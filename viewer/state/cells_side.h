// What is drawn for the view cell of the eye, and what a walk through cells has come to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "objects.h"
#include "occlod/cell_walker.h"
#include "occlod/refiner.h"
#include "palette.h"
#include "settings.h"
#include "view_cells.h"

namespace occlod::viewer {

// Frames with the eye in a leaf, since the walk began.
struct CellVisit {
  std::size_t frames = 0;
  std::size_t late = 0;  // of these
};

// What could not be loaded, in one line.
struct CellNote {
  std::uint64_t number = 0;  // ascending; 0: there was none
  std::string line;
};

// Sums are since the walk began.
struct CellsFrame {
  std::shared_ptr<const ViewCells> cells;
  WalkedFrame walked;  // without objects
  std::size_t frames = 0;
  std::size_t late = 0;     // frames
  std::size_t missing = 0;  // frames
  std::size_t crossings = 0;
  std::uint64_t bytes_read = 0;
  std::size_t loads = 0;
  std::map<CellId, CellVisit> visits;
  CellNote note;                   // the last one
  bool is_promised = false;        // the file's promise holds for this view: no more is magnified than it was built for
  std::size_t left_out = 0;        // triangles that are active in the cell and not drawn, when they are asked for
  std::vector<std::size_t> drawn;  // by object: of its triangles, the first so many; the others are left out
};

// Of triangles of the cell that are left out.
struct LeftOut {
  std::vector<Triangle> triangles;
  std::vector<CellKept> kept;  // facing_away or hidden
};

// By object, from what the file has for the leaf: `cut`, as read_cell() gives it. O(size of the hierarchy).
[[nodiscard]] LeftOut left_out_of(const ViewCells& cells, CellId leaf, std::size_t object, const CellObjectCut& cut);

// The ends of a logarithmic scale, over all leaves.
struct CellScale {
  double least = 0.0;
  double most = 0.0;
};
// `boxes`: triangles, error or bytes.
[[nodiscard]] CellScale scale_of(const ViewCells& cells, CellBoxes boxes);
// `scale`: for those.
[[nodiscard]] glm::u8vec4 box_color(const CellsFrame& frame, CellId leaf, CellBoxes boxes, const CellScale& scale);
[[nodiscard]] std::vector<LegendEntry> legend_of(const ViewCells& cells, CellBoxes boxes);

}  // namespace occlod::viewer
