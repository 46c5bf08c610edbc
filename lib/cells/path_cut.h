// The cut of one object at a node of the tree of cells.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "occlod/viewcells/vlod_file.h"

namespace occlod {

// Reuses its memory.
struct PathCut {
  std::vector<SplitId> applied;  // ascending
  std::vector<FaceRef> hidden;   // in the order of face_key()

  // `path`: what the nodes from the root to this one add. Faces that are hidden count in leaves only: those of other
  // nodes are hidden by what the leaves below have.
  void gather(std::uint32_t object, std::span<const CellAdditions* const> path, bool is_leaf);
};

}  // namespace occlod
