// How regions are cut into root cells, and cells into smaller ones.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "cells/leaf_faces.h"
#include "cells/vlod_format.h"
#include "occlod/cell_builder.h"
#include "occlod/vlod_file.h"

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

// Trees of cells as they are built: from the leaves up, each node with what its leaves have in common.

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

// Divides a root cell into a tree of cells and finds their cuts.

// Whether a cell that draws more than options.max_triangles is worth dividing into cells that draw so much.
[[nodiscard]] bool is_worth_dividing(const CellTreeOptions& options, std::size_t drawn,
                                     std::span<const std::size_t> drawn_by_parts);

// What was found for a cell.
struct CellContent {
  CellNode node;  // its box and counts
  CellSets sets;  // of its cut
};

// The tree of a root cell with this content, by the options. Calls content_of(box) for each box that is looked at, and
// done(share) for each leaf, with its share of the root cell; the sum is 1.
[[nodiscard]] CellSubtree divide_cell(const CellTreeOptions& options, CellContent root,
                                      const std::function<CellContent(const CellBox& box)>& content_of,
                                      const std::function<void(double share)>& done);

// Reuses its memory from cell to cell; one thread each. What it gives depends on nothing but the cell, the objects, the
// occluders and the options.
class CellDivider {
 public:
  // All outlive it. Without occluders nothing is hidden.
  CellDivider(std::span<const RefineObject> objects, const CellOccluders* occluders, const CellTreeOptions& options,
              const vlod::GlobalIds& ids);

  // As divide_cell().
  [[nodiscard]] CellSubtree divide(const CellBox& root, const std::function<void(double share)>& done);

  // Cuts that were found so far, also for cells that were divided.
  [[nodiscard]] std::size_t cuts() const noexcept { return cuts_; }

 private:
  [[nodiscard]] CellContent content_of(const CellBox& box);

  std::vector<RefineObject> objects_;
  const CellTreeOptions* options_;
  const vlod::GlobalIds* ids_;
  CellBuilder builder_;
  LeafFaces faces_;
  std::vector<FaceRef> drawn_, hidden_;
  std::size_t cuts_ = 0;
};

// One tree of all root cells.

// Above root cells there are blocks of 2, 4, 8 ... of them to every side, above those a node for each region, above
// these one for all; nodes with a single child are left out. Calls take(i) for each root cell in turn. Memory: the sets
// of eight trees a level.
[[nodiscard]] CellSubtree join_roots(std::span<const RootCell> roots,
                                     const std::function<CellSubtree(std::size_t)>& take);

}  // namespace occlod
