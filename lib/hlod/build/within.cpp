#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <list>
#include <map>
#include <tuple>
#include <utility>

#include "hlod/build/finish_level.h"
#include "hlod/build/within_points.h"
#include "occlod/build_hlod.h"
#include "splits/triangle_keys.h"

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

  // Chains do not tell a triangle and its opposite from none; counts do.
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

namespace {

// Adds errors of levels as if they were independent, as for nodes.
double joined(double child_error, double own) { return std::sqrt(child_error * child_error + own * own); }

constexpr double quarter_steps[] = {1.0, 1.18920711500272106672, 1.41421356237309504880, 1.68179283050742908606};

// Returns, per vertex of a node and its splits, the first vertex at the same place; empty without seams, where all
// places differ.
std::vector<std::uint16_t> vertices_by_place(const Hlod& hlod, NodeId n) {
  if (!hlod.data().has_seams) return {};
  const std::span<const glm::vec3> own = hlod.mesh(n).positions, more = hlod.within(n).positions;
  using Place = std::array<std::uint32_t, 3>;
  std::vector<std::pair<Place, std::uint16_t>> sorted(own.size() + more.size());
  for (std::size_t v = 0; v < sorted.size(); ++v) {
    const glm::vec3& p = v < own.size() ? own[v] : more[v - own.size()];
    sorted[v] = {{bits_of(p.x), bits_of(p.y), bits_of(p.z)}, static_cast<std::uint16_t>(v)};
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::uint16_t> first(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i)
    first[sorted[i].second] =
        i > 0 && sorted[i].first == sorted[i - 1].first ? first[sorted[i - 1].second] : sorted[i].second;
  return first;
}

}  // namespace

std::uint32_t splits_to_error(const Hlod& hlod, NodeId n, double max_error) {
  if (!hlod.has_within(n)) return 0;
  const Node& node = hlod.node(n);
  if (max_error >= static_cast<double>(node.error)) return 0;
  const auto child_error = static_cast<double>(node.child_error);
  const auto errors = hlod.within(n).errors;
  const double most = std::max(max_error, child_error);
  const auto end = std::partition_point(errors.begin(), errors.end(), [&](float error) {
    return error > 0.0F && joined(child_error, static_cast<double>(error)) > most;
  });
  return static_cast<std::uint32_t>(end - errors.begin());
}

double error_of_splits(const Hlod& hlod, NodeId n, std::uint32_t splits) {
  const Node& node = hlod.node(n);
  if (splits == 0) return static_cast<double>(node.error);
  const auto errors = hlod.within(n).errors;
  const double own = splits < errors.size() ? static_cast<double>(errors[splits]) : 0.0;
  return std::min(joined(static_cast<double>(node.child_error), own), static_cast<double>(node.error));
}

NodeCut cut_with_splits(const Hlod& hlod, NodeId n, std::uint32_t splits) {
  const NodeSplits within = hlod.within(n);
  assert(splits <= within.parents.size());
  const std::vector<std::uint16_t> vertices = vertices_by_place(hlod, n);
  const std::size_t first = hlod.node(n).vertices + std::size_t{hlod.data().within[n].bare};
  splits = whole_splits(hlod, n, splits);
  std::vector<std::uint16_t> stands_for(first + within.parents.size());
  for (std::size_t v = 0; v < stands_for.size(); ++v)
    stands_for[v] = v < first + splits ? static_cast<std::uint16_t>(v) : stands_for[within.parents[v - first]];
  const auto by_place = [&](const Triangle& t) {
    return vertices.empty() ? t : Triangle(vertices[t.x], vertices[t.y], vertices[t.z]);
  };
  std::vector<Triangle> triangles, corners, before;
  for (std::size_t i = 0; i < within.indices.size(); i += 3) {
    const Triangle input(within.indices[i], within.indices[i + 1], within.indices[i + 2]);
    const Triangle corner(stands_for[input.x], stands_for[input.y], stands_for[input.z]);
    const Triangle t = by_place(corner);
    if (t.x == t.y || t.y == t.z || t.z == t.x) continue;
    triangles.push_back(t);
    before.push_back(by_place(input));
    if (!vertices.empty()) corners.push_back(corner);
  }
  cancel_folded(triangles, corners, before);
  NodeCut cut{splits, {}};
  cut.indices.reserve(3 * triangles.size());
  for (const Triangle& t : vertices.empty() ? triangles : corners)
    for (int k = 0; k < 3; ++k) cut.indices.push_back(static_cast<std::uint16_t>(t[k]));
  return cut;
}

NodeCut within_cut(const Hlod& hlod, NodeId n, double max_error) {
  if (hlod.has_within(n)) {
    hlod.require_within(n);
    return cut_with_splits(hlod, n, splits_to_error(hlod, n, max_error));
  }
  hlod.require(n);
  const NodeMesh mesh = hlod.mesh(n);
  return {0, {mesh.indices.begin(), mesh.indices.end()}};
}

double error_step(double x) {
  if (!(x > 0.0)) return 0.0;
  int exponent = 0;
  const double mantissa = 2.0 * std::frexp(std::min(x, std::numeric_limits<double>::max()), &exponent);  // in [1, 2)
  const auto* const above = std::upper_bound(std::begin(quarter_steps), std::end(quarter_steps), mantissa);
  return std::ldexp(above[-1], exponent - 1);
}

class CutCache::Impl {
 public:
  explicit Impl(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  void begin_frame() {
    while (bytes_ > max_bytes_ && !used_.empty()) {
      const auto oldest = cuts_.find(used_.front());
      bytes_ -= bytes_of(oldest->second.cut);
      cuts_.erase(oldest);
      used_.pop_front();
    }
  }

  const NodeCut& get(const Hlod& hlod, NodeId n, double max_error) {
    static const NodeCut none;
    if (!hlod.has_within(n) || max_error >= static_cast<double>(hlod.node(n).error)) return none;
    hlod.require_within(n);
    const std::uint32_t splits = splits_to_error(hlod, n, error_step(max_error));
    if (splits == 0) return none;
    const Key key{&hlod, n, splits};
    auto found = cuts_.find(key);
    if (found == cuts_.end()) {
      NodeCut cut = cut_with_splits(hlod, n, splits);
      bytes_ += bytes_of(cut);
      found = cuts_.emplace(key, Entry{std::move(cut), used_.insert(used_.end(), key)}).first;
    } else {
      used_.splice(used_.end(), used_, found->second.place);
    }
    return found->second.cut;
  }

  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }

 private:
  using Key = std::tuple<const Hlod*, NodeId, std::uint32_t>;  // the last is the number of splits
  struct Entry {
    NodeCut cut;
    std::list<Key>::iterator place;  // in used_
  };

  static std::size_t bytes_of(const NodeCut& cut) {
    return sizeof(Entry) + cut.indices.size() * sizeof(cut.indices[0]);
  }

  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::map<Key, Entry> cuts_;
  std::list<Key> used_;  // longest unused first
};

CutCache::CutCache(std::size_t max_bytes) : impl_(std::make_unique<Impl>(max_bytes)) {}
CutCache::CutCache(CutCache&&) noexcept = default;
CutCache& CutCache::operator=(CutCache&&) noexcept = default;
CutCache::~CutCache() = default;

void CutCache::begin_frame() { impl_->begin_frame(); }

const NodeCut& CutCache::get(const Hlod& hlod, NodeId n, double max_error) { return impl_->get(hlod, n, max_error); }

std::size_t CutCache::bytes() const noexcept { return impl_->bytes(); }

}  // namespace occlod::hlod
