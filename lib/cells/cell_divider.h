// Divides regions into root cells and cells into smaller ones.
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

// Returns the root cells of all regions in order; within one region they follow a Hilbert curve, so that, for any n,
// cells whose places differ only in the lowest n bits are consecutive. Throws Error when there are too many. O(n log
// n).
[[nodiscard]] std::vector<RootCell> root_cells(const CellTreeOptions& options);

// Halves every axis of the box that is longer than 0.7 times the longest and whose halves are no shorter than
// `smallest`; returns the box itself where there is none. Parts with smaller coordinates come first, x before y before
// z.
[[nodiscard]] std::vector<CellBox> parts_of(const CellBox& box, double smallest);

// Returns the position of x along the curve through a cube of 2^21 cells along each axis. (Skilling, Programming the
// Hilbert curve, 2004.)
[[nodiscard]] std::uint64_t hilbert_index(std::array<std::uint32_t, 3> x);

// Builds trees of cells from the leaves up; each node holds what its leaves have in common.

// Holds what the leaves of a tree apply and draw, as ascending vlod::GlobalIds.
struct CellSets {
  std::vector<std::uint64_t> splits;      // applied by all leaves
  std::vector<std::uint64_t> used;        // applied by some leaf
  std::vector<std::uint64_t> candidates;  // applied by leaves below two of the root's children, but not by all leaves
  std::vector<std::uint64_t> hidden;      // faces, owner << 32 | slot, hidden in some leaf and drawn in none
  std::vector<std::uint64_t> drawn;       // faces drawn in some leaf
};

// A tree whose root is not yet part of a larger tree: what the root adds depends on that tree and is not yet known.
struct CellSubtree {
  std::vector<CellNode> nodes;  // `parent` and `end` count from the first, `payload` from the start of `payloads`;
                                // levels are not yet known, nor the payload of the first
  std::vector<std::byte> payloads;
  CellSets sets;
};

// Makes the tree of a cell that is not divided, with the splits, hidden and drawn faces of its cut.
[[nodiscard]] CellSubtree leaf_of_tree(const CellNode& node, CellSets sets);
// Joins several trees, at least two, into one. O(size of their sets + bytes).
[[nodiscard]] CellSubtree join(std::vector<CellSubtree> parts);
// Sets the levels of all nodes.
void set_levels(CellSubtree& tree);
// Finishes the nodes with levels and payloads: the root adds what all leaves have.
void finish(CellSubtree& tree);

// Divides a root cell into a tree of cells and computes their cuts.

// Returns whether a cell that draws more than options.max_triangles is worth dividing into cells that draw this many.
[[nodiscard]] bool is_worth_dividing(const CellTreeOptions& options, std::size_t drawn,
                                     std::span<const std::size_t> drawn_by_parts);

// Holds the result for one cell.
struct CellContent {
  CellNode node;  // its box and counts
  CellSets sets;  // of its cut
};

// Returns the tree of a root cell with this content, according to the options. Calls content_of(box) for each box that
// is considered, and done(share) for each leaf, with its share of the root cell; the shares add up to 1.
[[nodiscard]] CellSubtree divide_cell(const CellTreeOptions& options, CellContent root,
                                      const std::function<CellContent(const CellBox& box)>& content_of,
                                      const std::function<void(double share)>& done);

// Divides cells, reusing its memory; each thread needs its own. The result depends only on the cell, the objects, the
// occluders and the options.
class CellDivider {
 public:
  // All arguments must outlive this object. Without occluders nothing is hidden.
  CellDivider(std::span<const RefineObject> objects, const CellOccluders* occluders, const CellTreeOptions& options,
              const vlod::GlobalIds& ids);

  // Divides a root cell as divide_cell() does.
  [[nodiscard]] CellSubtree divide(const CellBox& root, const std::function<void(double share)>& done);

  // Returns the number of cuts computed so far, including those of cells that were divided.
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

// Joins the trees of all root cells into one.

// Builds the upper levels: blocks of 2, 4, 8 ... root cells along each axis, above those a node for each region, above
// these one root; nodes with a single child are left out. Calls take(i) for each root cell in order. Memory: the sets
// of eight trees per level.
[[nodiscard]] CellSubtree join_roots(std::span<const RootCell> roots,
                                     const std::function<CellSubtree(std::size_t)>& take);

}  // namespace occlod
