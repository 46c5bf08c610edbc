// Divides a root cell into a tree of cells and finds their cuts.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "occlod/viewcells/cell_builder.h"
#include "occlod/viewcells/cell_options.h"
#include "viewcells/cell_subtree.h"
#include "viewcells/leaf_faces.h"
#include "viewcells/vlod_format.h"

namespace occlod {

// Whether a cell that draws more than options.most_triangles is worth dividing into cells that draw so much.
[[nodiscard]] bool is_worth_dividing(const CellTreeOptions& options, std::size_t drawn,
                                     std::span<const std::size_t> drawn_by_parts);

// Reuses its memory from cell to cell; one thread each. What it gives depends on nothing but the cell, the objects, the
// occluders and the options.
class CellDivider {
 public:
  // All outlive it. Without occluders nothing is hidden.
  CellDivider(std::span<const RefineObject> objects, const CellOccluders* occluders, const CellTreeOptions& options,
              const vlod::GlobalIds& ids);

  // Calls done(share) for each leaf, with its share of the root cell; the sum is 1.
  [[nodiscard]] CellSubtree divide(const CellBox& root, const std::function<void(double share)>& done);

  // Cuts that were found so far, also for cells that were divided.
  [[nodiscard]] std::size_t cuts() const noexcept { return cuts_; }

 private:
  struct Cell {
    CellNode node;
    CellSets sets;
  };
  [[nodiscard]] Cell cut_of(const CellBox& box);
  [[nodiscard]] CellSubtree divide(Cell cell, std::uint32_t level, double share,
                                   const std::function<void(double share)>& done);

  std::vector<RefineObject> objects_;
  const CellTreeOptions* options_;
  const vlod::GlobalIds* ids_;
  CellBuilder builder_;
  LeafFaces faces_;
  std::vector<FaceRef> drawn_, hidden_;
  std::size_t cuts_ = 0;
};

}  // namespace occlod
