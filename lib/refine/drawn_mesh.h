// The active triangles of a cut in an order that changes as little as the cut does: an index buffer that need not be
// uploaded anew.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/memory.h"
#include "occlod/refiner.h"
#include "refine/cut.h"

namespace occlod {

// Knows the place of every active face. Memory is proportional to the cut.
class FaceList {
 public:
  // `triangles`: where they are kept, with nothing else. Both outlive it.
  FaceList(const Hierarchy& hierarchy, std::vector<Triangle>& triangles);

  // All faces of `cut` from scratch, base faces first, then by split and slot. O(n log n).
  void assign(const Cut& cut);
  // What is told by changes() starts here.
  void begin_frame() noexcept;

  // Call when the cut applies s, after the splits that s needs, or takes it back.
  void apply(SplitId s);
  void take_back(SplitId s);

  // The places of triangles that differ from those at begin_frame(), ascending and apart. O(c log c) for c changes.
  void changes(std::vector<TriangleRange>& out);

 private:
  static constexpr std::uint32_t nowhere = no_id;

  [[nodiscard]] std::uint32_t& place_of(const FaceRef& face);
  // A face by its wedges.
  [[nodiscard]] Triangle drawn(const FaceRef& face, const Triangle& vertices) const;
  void put(std::uint32_t place, const FaceRef& face, const Triangle& triangle);
  void add(const FaceRef& face, const Triangle& triangle);
  void fill_holes();
  void touch(std::uint32_t place);
  void new_block_of(SplitId s);
  void free_block_of(SplitId s);

  const Hierarchy* hierarchy_;
  std::vector<Triangle>* triangles_;
  std::vector<FaceRef> faces_;         // at each place
  std::vector<std::uint32_t> frames_;  // in which each place was last changed
  std::uint32_t frame_ = 0;
  std::vector<std::uint32_t> touched_;  // places, in this frame
  std::vector<std::uint32_t> holes_;    // places whose faces have just been removed

  std::vector<std::uint32_t> base_places_;
  ZeroedArray<std::uint32_t> blocks_;  // of each split: where the places of its faces start in places_, plus 1
  std::vector<std::uint32_t> places_;  // of faces of applied splits, by slot
  std::vector<SplitId> owners_;        // at the first place of each block its split, else no_id
  std::vector<std::vector<std::uint32_t>> free_blocks_;  // by size
};

// The mesh of one object as the caller draws it, from frame to frame.

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
