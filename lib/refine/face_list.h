// The active triangles of a cut in an order that changes as little as the cut does: an index buffer that need not be
// uploaded anew.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/zeroed_array.h"
#include "refine/cut.h"
#include "occlod/refine/refiner.h"

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

}  // namespace occlod
