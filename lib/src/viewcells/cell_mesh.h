// What is drawn for a node of a tree of cells, ready to be drawn: its triangles, in blocks for the frustum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "occlod/refine/refiner.h"
#include "occlod/viewcells/cell_tree.h"
#include "occlod/viewcells/cell_walker.h"
#include "occlod/viewcells/vlod_file.h"
#include "viewcells/leaf_faces.h"

namespace occlod {

// Immutable once it is made.
struct CellMesh {
  std::vector<Triangle> triangles;    // of all objects
  std::vector<TriangleBlock> blocks;  // of all objects
  struct Object {
    std::uint32_t first_triangle = 0, triangles = 0, first_block = 0, blocks = 0;
  };
  std::vector<Object> objects;
  double error_px = 0.0;  // of a leaf as the file has it; of other nodes for all eyes in its box, see CellMeshMaker

  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof(*this) + triangles.capacity() * sizeof(Triangle) + blocks.capacity() * sizeof(TriangleBlock) +
           objects.capacity() * sizeof(Object);
  }
};

// Reuses its memory; one thread each.
class CellMeshMaker {
 public:
  // Both outlive it.
  CellMeshMaker(const VlodFile& file, std::span<const RefineObject> objects);

  // `path`: what the nodes from the root to this one add. A leaf is drawn as read_cell() gives it. Of another node all
  // faces are drawn that do not turn away from its box: those hidden in the leaves below are hidden by what these
  // have. Its error is that of all splits that it lacks, seen or not. O(size of the cut).
  [[nodiscard]] CellMesh make(CellId cell, std::span<const CellAdditions* const> path);

 private:
  void gather(std::uint32_t object, std::span<const CellAdditions* const> path, bool with_hidden);
  [[nodiscard]] double error_px(std::uint32_t object, const CellView& view) const;
  void append(std::uint32_t object, CellMesh& mesh);

  const VlodFile& file_;
  std::vector<RefineObject> objects_;
  LeafFaces faces_;
  std::vector<SplitId> applied_;  // of the object at hand
  std::vector<FaceRef> hidden_;   // of it
  std::vector<Triangle> drawn_;   // of it
};

}  // namespace occlod
