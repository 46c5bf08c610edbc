#include "hlod/build/within_points.h"

#include <algorithm>
#include <cmath>

namespace occlod::hlod {

WithinPoints::WithinPoints(const Hlod& hlod, const PositionIds& points) : hlod_(hlod), points_(points) {
  if (hlod.data().within.empty()) return;
  first_.resize(hlod.node_count(), 0);
  number_of_.resize(points.positions().size(), 0);
}

std::size_t WithinPoints::first_split(NodeId n) const {
  return hlod_.node(n).vertices + std::size_t{hlod_.data().within[n].bare};
}

Triangle WithinPoints::triangle(NodeId n, std::span<const std::uint16_t> indices, std::size_t i) const {
  const std::size_t first = first_[n];
  return {points_of_[first + indices[i]], points_of_[first + indices[i + 1]], points_of_[first + indices[i + 2]]};
}

ChainSum WithinPoints::triangles(NodeId n, std::span<const std::uint16_t> indices) const {
  ChainSum sum;
  for (std::size_t i = 0; i < indices.size(); i += 3) sum.add(triangle(n, indices, i));
  return sum;
}

ChainSum WithinPoints::edges(NodeId n, std::uint32_t splits) const {
  const NodeCut cut = cut_with_splits(hlod_, n, splits);
  ChainSum sum;
  for (std::size_t i = 0; i < cut.indices.size(); i += 3)
    for_each_edge(triangle(n, cut.indices, i), [&](PointId from, PointId to) { sum.add(from, to); });
  return sum;
}

std::optional<std::string> WithinPoints::add(NodeId n, std::span<const PointId> own, const ChainSum& input) {
  const NodeSplits within = hlod_.within(n);
  first_[n] = points_of_.size();
  points_of_.insert(points_of_.end(), own.begin(), own.end());
  for (const glm::vec3& p : within.positions) points_of_.push_back(points_.find(p));
  std::vector<PointId> sorted(points_of_.begin() + static_cast<std::ptrdiff_t>(first_[n]), points_of_.end());
  std::sort(sorted.begin(), sorted.end());
  if (sorted.back() == no_id) return "have a vertex that is none of the input";
  if (!hlod_.data().has_seams && std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    return "have a vertex twice";
  for (std::size_t number = first_split(n); number < sorted.size(); ++number)
    number_of_[points_of_[first_[n] + number]] = static_cast<std::uint16_t>(number);

  // Chains do not tell a triangle from none when its opposite is there too; counts do.
  const NodeCut full = cut_with_splits(hlod_, n, hlod_.data().within[n].splits), none = cut_with_splits(hlod_, n, 0);
  if (full.indices.size() != within.indices.size() || !(triangles(n, full.indices) == input))
    return "do not lead back to the triangles that it was made from";
  const auto indices = hlod_.mesh(n).indices;
  if (none.indices.size() != indices.size() || !(triangles(n, none.indices) == triangles(n, indices)))
    return "do not begin with its mesh";
  const Node& node = hlod_.node(n);
  const auto inherited = static_cast<double>(node.child_error), own_error = static_cast<double>(within.errors[0]);
  if (std::sqrt(inherited * inherited + own_error * own_error) > static_cast<double>(node.error))
    return "have a larger error than it";
  return {};
}

PointId WithinPoints::moved(PointId p, NodeId n, std::uint32_t splits) const {
  const auto parents = hlod_.within(n).parents;
  const std::size_t first = first_split(n);
  std::size_t number = number_of_[p];
  while (number >= first + splits) number = parents[number - first];
  return points_of_[first_[n] + number];
}

}  // namespace occlod::hlod
