// The faces of the cut of a leaf: which are drawn, which are hidden, which face away.
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

// Reuses its memory from cell to cell; one thread each.
class LeafFaces {
 public:
  // Their hierarchies outlive it.
  explicit LeafFaces(std::span<const RefineObject> objects);

  // The cut of this object, from now on. `applied`: ascending, closed under dependency. O(applied).
  void set(std::uint32_t object, std::span<const SplitId> applied);

  // The faces that are in `drawn`, and of all others those that do not face away: ascending. `drawn`: active triangles
  // of wedges in the order of their faces. Clears both. O(faces).
  void classify(std::uint32_t object, const CellView& view, std::span<const Triangle> drawn,
                std::vector<FaceRef>& drawn_faces, std::vector<FaceRef>& hidden_faces);
  // The wedges of the faces that are not in `hidden`, ascending, and do not face away. Clears `drawn`. O(faces).
  void drawn(std::uint32_t object, const CellView& view, std::span<const FaceRef> hidden, std::vector<Triangle>& drawn);

 private:
  [[nodiscard]] bool faces_away(std::uint32_t object, const CellView& view, const Triangle& t) const;

  std::vector<RefineObject> objects_;
  std::vector<Cut> cuts_;
};

// The cut of one object at a node of the tree of cells.

// Reuses its memory.
struct PathCut {
  std::vector<SplitId> applied;  // ascending
  std::vector<FaceRef> hidden;   // in the order of face_key()

  // `path`: what the nodes from the root to this one add. Faces that are hidden count in leaves only: those of other
  // nodes are hidden by what the leaves below have.
  void gather(std::uint32_t object, std::span<const CellAdditions* const> path, bool is_leaf);
};

}  // namespace occlod
