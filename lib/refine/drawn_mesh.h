// The mesh of one object as the caller draws it, from frame to frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "refine/cut.h"
#include "refine/face_list.h"
#include "occlod/refine/refiner.h"

namespace occlod {

// Follows a cut: its triangles keep their places, and what has come and gone in a frame is known. Reuses its memory.
class DrawnMesh {
 public:
  // Keeps its triangles in `triangles`, which outlive it.
  DrawnMesh(const Hierarchy& hierarchy, std::vector<Triangle>& triangles) : faces_(hierarchy, triangles) {}

  void begin_frame();
  // After begin_frame(): a cut that has nothing to do with that of the frame before.
  void assign(const Cut& cut);
  // When the cut applies s, after the splits that s needs, or takes it back.
  void apply(SplitId s);
  void take_back(SplitId s);
  // Applied in this frame, some perhaps several times; after emit() each once, of those that are applied still and were
  // not in the frame before.
  [[nodiscard]] const std::vector<SplitId>& born() const noexcept { return born_; }

  // Brings `out`, as the frame before has left it, to the cut. `geomorph_frames`: see RefineOptions.
  void emit(const Cut& cut, std::uint32_t geomorph_frames, RefinedObject& out, RefineStats& stats);

 private:
  void emit_splits(const Cut& cut, std::vector<SplitId>& out, RefineStats& stats);
  void emit_all_splits(const Cut& cut, std::vector<SplitId>& out, RefineStats& stats) const;
  static void emit_wedge_geomorphs(const Hierarchy& hierarchy, SplitId s, float t, std::vector<Geomorph>& out);
  void emit_geomorphs(const Cut& cut, std::uint32_t geomorph_frames, std::vector<Geomorph>& out);

  FaceList faces_;
  bool assigned_ = false;  // in this frame
  std::uint32_t frame_ = 0;
  std::vector<SplitId> born_, died_;                       // in this frame
  std::vector<std::pair<SplitId, std::uint32_t>> morphs_;  // splits with the frames in which they were applied
  std::vector<SplitId> kept_;                              // scratch
};

}  // namespace occlod
