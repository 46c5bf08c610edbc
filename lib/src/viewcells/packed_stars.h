// The stars and vertices of a hierarchy under the numbers of a packed file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"
#include "viewcells/geometry_frame.h"

namespace occlod::vlod {

// One mesh of a packed file: which splits it has, in their order there.
class PackedStars {
 public:
  // `splits`: of the hierarchy, which outlives this: each after those that it needs, all of which are there.
  PackedStars(const Hierarchy& hierarchy, std::vector<SplitId> splits);

  [[nodiscard]] MeshRow row() const;
  [[nodiscard]] std::span<const SplitId> splits() const noexcept { return splits_; }
  [[nodiscard]] const Hierarchy& hierarchy() const noexcept { return hierarchy_; }
  // no_id: it is not there.
  [[nodiscard]] SplitId number_of(SplitId split) const noexcept { return split == no_id ? no_id : numbers_[split]; }

  // Behind what the frame has: split `number` of the file.
  void append(SplitId number, GeometryFrame& frame) const;

 private:
  [[nodiscard]] VertexId vertex(VertexId v) const noexcept;
  [[nodiscard]] Triangle triangle(const Triangle& t) const noexcept { return {vertex(t.x), vertex(t.y), vertex(t.z)}; }

  const Hierarchy& hierarchy_;
  std::vector<SplitId> splits_, numbers_;  // by the other number
};

}  // namespace occlod::vlod
