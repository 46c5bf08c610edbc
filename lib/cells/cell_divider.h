// Divides a root cell into a tree of cells and finds their cuts.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "occlod/viewcells/cell_builder.h"
#include "occlod/viewcells/cell_options.h"
#include "cells/cell_subtree.h"
#include "cells/leaf_faces.h"
#include "cells/vlod_format.h"

namespace occlod {

// Whether a cell that draws more than options.most_triangles is worth dividing into cells that draw so much.
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

}  // namespace occlod
