// Keeps the active triangles of a cut in an order that changes as little as the cut does, so that an index buffer need
// not be uploaded anew.
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
  // Keeps the triangles in `triangles`, which holds nothing else. Both arguments must outlive this object.
  FaceList(const Hierarchy& hierarchy, std::vector<Triangle>& triangles);

  // Replaces all faces with those of `cut`, in the order of Cut::for_each_active(). O(n).
  void assign(const Cut& cut);
  // Starts the frame whose changes changes() returns.
  void begin_frame() noexcept;

  // Call these when the cut applies s, after the splits that s needs, or takes it back.
  void apply(SplitId s);
  void take_back(SplitId s);

  // Writes the places of triangles that differ from those at begin_frame(), as ascending, disjoint ranges. O(c log c)
  // for c changes.
  void changes(std::vector<TriangleRange>& out);

 private:
  static constexpr std::uint32_t nowhere = no_id;

  [[nodiscard]] std::uint32_t& place_of(const FaceRef& face);
  // Returns the face with wedge ids.
  [[nodiscard]] Triangle drawn(const FaceRef& face, const Triangle& vertices) const;
  void put(std::uint32_t place, const FaceRef& face, const Triangle& triangle);
  void add(const FaceRef& face, const Triangle& triangle);
  void fill_holes();
  void touch(std::uint32_t place);
  void new_block_of(SplitId s);
  void free_block_of(SplitId s);

  const Hierarchy* hierarchy_;
  std::vector<Triangle>* triangles_;
  std::vector<FaceRef> faces_;         // per place
  std::vector<std::uint32_t> frames_;  // frame in which each place was last changed
  std::uint32_t frame_ = 0;
  std::vector<std::uint32_t> touched_;  // places changed in this frame
  std::vector<std::uint32_t> holes_;    // places whose faces have just been removed

  std::vector<std::uint32_t> base_places_;
  ZeroedArray<std::uint32_t> blocks_;  // per split: 1 + index in places_ where its faces start; 0 = none
  std::vector<std::uint32_t> places_;  // places of the faces of applied splits, by slot
  std::vector<SplitId> owners_;        // per index in places_: the split whose block starts there, else no_id
  std::vector<std::vector<std::uint32_t>> free_blocks_;  // indices in places_, by size
};

// Holds the mesh of one object as the caller draws it. Follows a cut from frame to frame: triangles keep their places,
// and changes are known. Reuses its memory.
class DrawnMesh {
 public:
  // Keeps its triangles in `triangles`, which must outlive it.
  DrawnMesh(const Hierarchy& hierarchy, std::vector<Triangle>& triangles) : faces_(hierarchy, triangles) {}

  void begin_frame();
  // Takes over a cut that is unrelated to that of the frame before. Call it after begin_frame().
  void assign(const Cut& cut);
  // Call these when the cut applies s, after the splits that s needs, or takes it back.
  void apply(SplitId s);
  void take_back(SplitId s);
  // Returns the splits applied in this frame, some perhaps several times; after emit() each once, and only those that
  // are still applied and were not in the frame before.
  [[nodiscard]] const std::vector<SplitId>& born() const noexcept { return born_; }

  // Updates `out` from the frame before to the cut. `geomorph_frames`: see RefineOptions.
  void emit(const Cut& cut, std::uint32_t geomorph_frames, RefinedObject& out, RefineStats& stats);

 private:
  void emit_splits(const Cut& cut, std::vector<SplitId>& out, RefineStats& stats);
  void emit_all_splits(const Cut& cut, std::vector<SplitId>& out, RefineStats& stats) const;
  static void emit_wedge_geomorphs(const Hierarchy& hierarchy, SplitId s, float t, std::vector<Geomorph>& out);
  void emit_geomorphs(const Cut& cut, std::uint32_t geomorph_frames, std::vector<Geomorph>& out);

  FaceList faces_;
  bool assigned_ = false;  // whether assign() was called in this frame
  std::uint32_t frame_ = 0;
  std::vector<SplitId> born_, died_;                       // splits applied and taken back in this frame
  std::vector<std::pair<SplitId, std::uint32_t>> morphs_;  // splits with the frames in which they were applied
  std::vector<SplitId> kept_;                              // scratch
};

}  // namespace occlod
