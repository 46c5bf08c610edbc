// The stars and vertices of a hierarchy under the numbers of a packed file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "splits/structure.h"
#include "occlod/hierarchy/hierarchy.h"
#include "cells/geometry_frame.h"

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

  // Calls visit(wedge) for each that the file has of a vertex: its first one, and those of the others that some face of
  // the file has. They are numbered in this order.
  template <typename Visit>
  void for_each_wedge(VertexId v, const Visit& visit) const {
    visit(v);
    const WedgeRange extra = extra_wedges_of(hierarchy_.data(), v);
    for (WedgeId w = extra.first; w < extra.first + extra.count; ++w)
      if (number_of_wedge(w) != no_id) visit(w);
  }
  // Of a face: for each corner the number of its wedge.
  [[nodiscard]] Triangle corners(const Triangle& wedges) const noexcept {
    return {number_of_wedge(wedges.x), number_of_wedge(wedges.y), number_of_wedge(wedges.z)};
  }

 private:
  void number_wedges();
  void append_corners(SplitId split, std::uint32_t extra, GeometryFrame& frame) const;
  [[nodiscard]] std::uint32_t number_of_wedge(WedgeId wedge) const noexcept {
    return wedge < hierarchy_.vertex_count() ? 0 : wedge_numbers_[wedge - hierarchy_.vertex_count()];
  }
  [[nodiscard]] VertexId vertex(VertexId v) const noexcept;
  [[nodiscard]] Triangle triangle(const Triangle& t) const noexcept { return {vertex(t.x), vertex(t.y), vertex(t.z)}; }

  const Hierarchy& hierarchy_;
  std::vector<SplitId> splits_, numbers_;     // by the other number
  std::vector<std::uint32_t> wedge_numbers_;  // of extra wedges: from 1 on, or no_id where no face of the file has it
};

}  // namespace occlod::vlod
