// Classifies the faces of the cut of a leaf as drawn, hidden, or facing away.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "occlod/cell_builder.h"
#include "occlod/refiner.h"
#include "occlod/vlod_file.h"
#include "refine/cut.h"

namespace occlod {

// Orders faces as Cut::for_each_active() visits those of a sorted cut.
[[nodiscard]] constexpr std::uint64_t face_key(const FaceRef& face) noexcept {
  return face.split == no_id ? face.slot : (face.split + std::uint64_t{1}) << 32U | face.slot;
}

// Reuses its memory from cell to cell; each thread needs its own.
class LeafFaces {
 public:
  // The hierarchies of the objects must outlive this object.
  explicit LeafFaces(std::span<const RefineObject> objects);

  // Sets the cut of this object. `applied` is ascending and closed under dependency. Takes least where it differs
  // little from the last cut, as those of neighbouring cells do. See Cut::set().
  void set(std::uint32_t object, std::span<const SplitId> applied);
  // Returns whether the cut of this object applies the split.
  [[nodiscard]] bool applies(std::uint32_t object, SplitId s) const noexcept { return cuts_[object].applied(s); }

  // Returns, ascending, the faces that are in `drawn`, and those of the others that do not face away. `drawn` holds
  // active triangles of wedges in the order of their faces. Clears both outputs first. O(faces).
  void classify(std::uint32_t object, const CellView& view, std::span<const Triangle> drawn,
                std::vector<FaceRef>& drawn_faces, std::vector<FaceRef>& hidden_faces);
  // Returns, ascending, the wedges of the faces that are not in `hidden` and do not face away. Clears `drawn` first.
  // O(faces).
  void drawn(std::uint32_t object, const CellView& view, std::span<const FaceRef> hidden, std::vector<Triangle>& drawn);

 private:
  [[nodiscard]] bool faces_away(std::uint32_t object, const CellView& view, const Triangle& t) const;

  std::vector<RefineObject> objects_;
  std::vector<Cut> cuts_;
};

// Holds the cut of one object at a node of the tree of cells.

// Reuses its memory.
struct PathCut {
  std::vector<SplitId> applied;  // ascending
  std::vector<FaceRef> hidden;   // in the order of face_key()

  // Gathers the cut from `path`: what the nodes from the root to this one add. Hidden faces count only in leaves: those
  // of other nodes are hidden by geometry of the leaves below.
  void gather(std::uint32_t object, std::span<const CellAdditions* const> path, bool is_leaf);
};

}  // namespace occlod
