// Maps the vertices of nodes refined within to positions of the input, for validate().
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

// Returns the smallest number of splits of node n, at least `splits`, that applies all splits of a position or none.
// O(splits at that position).
[[nodiscard]] inline std::uint32_t whole_splits(const Hlod& hlod, NodeId n, std::uint32_t splits) {
  if (!hlod.data().has_seams) return splits;
  const NodeWithin& within = hlod.data().within[n];
  const auto places = hlod.within(n).positions.subspan(within.bare);
  while (splits > 0 && splits < within.splits && places[splits] == places[splits - 1]) ++splits;
  return splits;
}

using PointId = std::uint32_t;  // id of a position of level 0

class WithinPoints {
 public:
  // Both references must outlive the object. `points` is complete.
  WithinPoints(const Hlod& hlod, const PositionIds& points);

  // Identifies the vertices of node n, which has splits; `own` are the points of its mesh. Checks the splits against
  // its mesh and against the triangles that it was made from, whose chain is `input`. Returns a description of the
  // first problem, or nothing.
  [[nodiscard]] std::optional<std::string> add(NodeId n, std::span<const PointId> own, const ChainSum& input);
  // Returns where point p, which node n has merged, lies when the first `splits` splits are applied. Node n has been
  // added.
  [[nodiscard]] PointId moved(PointId p, NodeId n, std::uint32_t splits) const;
  // Calls visit(p, position of p without splits) for each point that splits of n bring back.
  template <typename Visit>
  void for_each_merge(NodeId n, const Visit& visit) const {
    for (std::size_t s = 0; s < hlod_.data().within[n].splits; ++s) {
      const PointId p = points_of_[first_[n] + first_split(n) + s];
      visit(p, moved(p, n, 0));
    }
  }
  // Returns the chain of the edges of node n with this number of splits applied.
  [[nodiscard]] ChainSum edges(NodeId n, std::uint32_t splits) const;

 private:
  [[nodiscard]] std::size_t first_split(NodeId n) const;  // number of the first vertex that a split brings back
  [[nodiscard]] Triangle triangle(NodeId n, std::span<const std::uint16_t> indices, std::size_t i) const;
  [[nodiscard]] ChainSum triangles(NodeId n, std::span<const std::uint16_t> indices) const;

  const Hlod& hlod_;
  const PositionIds& points_;
  std::vector<std::size_t> first_;        // per node, its first place in points_of_
  std::vector<PointId> points_of_;        // points of all vertices of the nodes that have splits
  std::vector<std::uint16_t> number_of_;  // per point, its number in the node that merged it
};

}  // namespace occlod::hlod
