// Describes what is drawn for the view cell of the eye, and the walk through cells so far.
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

// Counts frames with the eye in a leaf, since the walk began.
struct CellVisit {
  std::size_t frames = 0;
  std::size_t late = 0;  // frames among these
};

// Tells in one line what could not be loaded.
struct CellNote {
  std::uint64_t number = 0;  // ascending; 0: none
  std::string line;
};

// Describes a frame of a walk. Sums are since the walk began.
struct CellsFrame {
  std::shared_ptr<const ViewCells> cells;
  WalkedFrame walked;  // without objects
  std::size_t frames = 0;
  std::size_t late = 0;     // number of frames
  std::size_t missing = 0;  // number of frames
  std::size_t crossings = 0;
  std::uint64_t bytes_read = 0;
  std::size_t loads = 0;
  std::map<CellId, CellVisit> visits;
  CellNote note;                   // the last note
  std::string unpromised;          // why the file's promise does not hold for the view; empty: it holds
  std::size_t left_out = 0;        // active triangles of the cell that are not drawn, if asked for
  std::vector<std::size_t> drawn;  // per object: this many of its triangles are drawn, the others are left out
};

// Holds triangles of the cell that are left out.
struct LeftOut {
  std::vector<Triangle> triangles;
  std::vector<CellKept> kept;  // facing_away or hidden
};

// Returns them for an object from what the file has for the leaf: `cut`, as read_cell() returns it. O(size of the
// hierarchy).
[[nodiscard]] LeftOut left_out_of(const ViewCells& cells, CellId leaf, std::size_t object, const CellObjectCut& cut);

// Holds the ends of a logarithmic scale over all leaves.
struct CellScale {
  double least = 0.0;
  double most = 0.0;
};
// Returns the scale of triangles, error or bytes.
[[nodiscard]] CellScale scale_of(const ViewCells& cells, CellBoxes boxes);
// Returns the colour of a leaf on that scale.
[[nodiscard]] glm::u8vec4 box_color(const CellsFrame& frame, CellId leaf, CellBoxes boxes, const CellScale& scale);
[[nodiscard]] std::vector<LegendEntry> legend_of(const ViewCells& cells, CellBoxes boxes);

}  // namespace occlod::viewer
