// The cuts of all objects for one cell, from what some of its eyes see.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "refine/cut.h"
#include "occlod/raster/item_buffer.h"
#include "occlod/viewcells/cell_builder.h"

namespace occlod {

// Draws the cuts from a grid of eyes to all six sides, with as many pixels as the eye model has. A face that owns a
// pixel is split while that changes it by more than the tolerance, until every eye sees faces that may stay. Those are
// drawn, and all that share a vertex with them and may show their front. (After Nirenstein and Blake 2004, whose images
// decide about triangles.) What is seen only between eyes or pixels is missing. The same for any number of threads.
class CellSampling {
 public:
  CellSampling(std::span<const RefineObject> objects, const CellOptions& options);

  const CellCut& build(const CellBox& cell);

 private:
  struct Object {
    Object(const RefineObject& object, const Hierarchy& hierarchy);

    [[nodiscard]] std::size_t place_of(const FaceRef& face) const {
      return face.slot + (face.split == no_id ? std::size_t{0} : first_face[face.split]);
    }

    RefineObject placed;
    Cut cut;
    std::vector<std::uint32_t> first_face;  // of each split, among all faces that ever exist; base faces come first
    std::vector<SplitId> remover;           // of each such face, or none
    std::vector<FaceRef> faces;             // active
    std::vector<Triangle> triangles;        // these
    std::vector<bool> seen;                 // of all faces that ever exist
  };

  void begin(const CellBox& cell);
  void gather(Object& object);
  // Until all that this eye sees to this side may stay. False when that was so before.
  bool refine(const View& view);
  void draw(const View& view);
  bool split_seen();
  // Whether the split changes its faces by more than the tolerance.
  [[nodiscard]] bool must_split(std::size_t place, SplitId s);
  void find_drawn(std::size_t place);

  CellOptions options_;
  std::vector<Object> objects_;
  std::vector<CellView> views_;
  ItemBuffer image_;
  CellCut result_;
};

}  // namespace occlod
