// Splits of one place belong together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "occlod/build_hlod.h"
#include "occlod/hlod.h"
#include "splits/positions.h"
#include "splits/triangle_keys.h"

namespace occlod::hlod {

// The least number of splits of node n, no less than `splits`, that applies all of a place or none. O(their number).
[[nodiscard]] inline std::uint32_t whole_splits(const Hlod& hlod, NodeId n, std::uint32_t splits) {
  if (!hlod.data().has_seams) return splits;
  const NodeWithin& within = hlod.data().within[n];
  const auto places = hlod.within(n).positions.subspan(within.bare);
  while (splits > 0 && splits < within.splits && places[splits] == places[splits - 1]) ++splits;
  return splits;
}

// The vertices of cuts within nodes by the positions of the input: for validate().

using PointId = std::uint32_t;  // of a position of level 0

class WithinPoints {
 public:
  // Both outlive it; `points` is complete.
  WithinPoints(const Hlod& hlod, const PositionIds& points);

  // Identifies the vertices of node n, which has splits: of its mesh they are `own`. Checks the splits against its mesh
  // and against the triangles that it was made from, whose chain is `input`. Returns what is wrong, or nothing.
  [[nodiscard]] std::optional<std::string> add(NodeId n, std::span<const PointId> own, const ChainSum& input);
  // Where point p, which node n has merged, is with the first `splits` splits applied; n has been added.
  [[nodiscard]] PointId moved(PointId p, NodeId n, std::uint32_t splits) const;
  // Calls visit(p, where p is without splits) for the points that splits of n bring back.
  template <typename Visit>
  void for_each_merge(NodeId n, const Visit& visit) const {
    for (std::size_t s = 0; s < hlod_.data().within[n].splits; ++s) {
      const PointId p = points_of_[first_[n] + first_split(n) + s];
      visit(p, moved(p, n, 0));
    }
  }
  // The chain of the edges of the cut of node n.
  [[nodiscard]] ChainSum edges(NodeId n, std::uint32_t splits) const;

 private:
  [[nodiscard]] std::size_t first_split(NodeId n) const;  // number of the first vertex that a split brings back
  [[nodiscard]] Triangle triangle(NodeId n, std::span<const std::uint16_t> indices, std::size_t i) const;
  [[nodiscard]] ChainSum triangles(NodeId n, std::span<const std::uint16_t> indices) const;

  const Hlod& hlod_;
  const PositionIds& points_;
  std::vector<std::size_t> first_;        // by node, into points_of_
  std::vector<PointId> points_of_;        // of all vertices of the nodes that have splits
  std::vector<std::uint16_t> number_of_;  // by point: its number in the node that merged it
};

}  // namespace occlod::hlod
