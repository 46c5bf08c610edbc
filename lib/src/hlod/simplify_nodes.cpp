#include "simplify_nodes.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

#include "cancel_opposite.h"
#include "finish_level.h"
#include "hierarchy/parallel.h"
#include "hierarchy/simplify_group.h"
#include "hierarchy/unit_scale.h"
#include "local_ids.h"
#include "math/unite.h"
#include "shared_vertices.h"

namespace occlod::hlod {
namespace {

constexpr std::size_t wanted_share = 4;    // a node is to have a quarter of its input's triangles,
constexpr std::size_t smallest_share = 8;  // and has at least an eighth
constexpr std::uint32_t sampled_groups = 32;

}  // namespace

// Simplifies one group after another.
class NodeSimplifier::Worker {
 public:
  Worker(const NodeSimplifier& all, const LevelDraft& below) : all_(all), below_(below) {}

  // The cost at which a quarter of the group's triangles is left.
  float sample(std::uint32_t group) {
    gather(group);
    return simplify(std::numeric_limits<float>::max(), all_.members(group).size() / wanted_share).cost;
  }

  SimplifiedNode run(std::uint32_t group, float most_cost, std::size_t least_triangles) {
    gather(group);
    const SimplifiedGroup simplified = simplify(most_cost, least_triangles);
    SimplifiedNode result;
    result.error = simplified.error;
    result.guaranteed_error = simplified.guaranteed_error;
    result.box = box();
    for (const Triangle& t : simplified.triangles) result.triangles.emplace_back(global(t.x), global(t.y), global(t.z));
    list_vertices(simplified, result);
    if (!simplified.collapses.empty() && input_.positions.size() <= stays) keep_splits(simplified, result.within);
    return result;
  }

 private:
  void gather(std::uint32_t group) {
    const std::span<const std::uint32_t> members = all_.members(group);
    ids_.reset(3 * members.size());
    input_.triangles.clear();
    for (const std::uint32_t member : members) {
      const Triangle& t = below_.triangles[member];
      const auto x = ids_.add(t.x), y = ids_.add(t.y), z = ids_.add(t.z);
      input_.triangles.emplace_back(x, y, z);
    }
    cancel_opposite(input_.triangles);
    input_.positions.clear();
    locked_.clear();
    for (const VertexId v : ids_.vertices()) {
      input_.positions.push_back(all_.mesh_.positions[v]);
      locked_.push_back(all_.locked_[v]);
    }
  }

  [[nodiscard]] VertexId global(std::uint32_t local) const { return ids_.vertices()[local]; }

  [[nodiscard]] SimplifiedGroup simplify(float most_cost, std::size_t least_triangles) const {
    return simplify_group(input_, locked_,
                          {all_.scale_, all_.options_.boundary_weight, most_cost, least_triangles,
                           all_.options_.within == Within::splits});
  }

  [[nodiscard]] Box box() const {
    Box box = all_.boxes_[global(0)];
    for (const VertexId v : ids_.vertices()) box = unite(box, all_.boxes_[v]);
    return box;
  }

  void list_vertices(const SimplifiedGroup& simplified, SimplifiedNode& result) {
    used_.assign(input_.positions.size(), 0);
    for (const Triangle& t : simplified.triangles) used_[t.x] = used_[t.y] = used_[t.z] = 1;
    for (std::uint32_t v = 0; v < used_.size(); ++v) {
      const std::uint32_t u = simplified.merged_into[v];
      if (u != v) {
        result.merges.push_back({global(v), global(u)});
        if (used_[u] == 0) result.bare_targets.push_back(global(u));
      }
      if (locked_[v] != 0 && used_[v] == 0) result.lost.push_back(global(v));
    }
    std::sort(result.bare_targets.begin(), result.bare_targets.end());
    result.bare_targets.erase(std::unique(result.bare_targets.begin(), result.bare_targets.end()),
                              result.bare_targets.end());
  }

  void keep_splits(const SimplifiedGroup& simplified, SplitsDraft& within) const {
    const auto own = [](std::uint32_t local) { return static_cast<std::uint16_t>(local); };
    within.vertices.assign(ids_.vertices().begin(), ids_.vertices().end());
    for (const Triangle& t : input_.triangles)
      for (int k = 0; k < 3; ++k) within.indices.push_back(own(t[k]));
    for (const GroupCollapse& c : simplified.collapses) within.splits.push_back({own(c.v), own(c.u), c.error});
  }

  const NodeSimplifier& all_;
  const LevelDraft& below_;
  LocalIds ids_;
  TriangleMesh input_;
  std::vector<std::uint8_t> locked_, used_;
};

NodeSimplifier::NodeSimplifier(const TriangleMesh& mesh, const BuildOptions& options, unsigned threads)
    : mesh_(mesh),
      options_(options),
      threads_(threads),
      scale_(power_of_two_scale(mesh.positions)),
      boxes_(mesh.vertex_count()),
      locked_(mesh.vertex_count(), 0),
      lost_(mesh.vertex_count(), 0) {
  for_each_id(mesh.vertex_count(), threads, [&](VertexId v) { boxes_[v] = {mesh.positions[v], mesh.positions[v]}; });
}

LevelDraft NodeSimplifier::run(LevelDraft& below, TriangleGroups groups, const ProgressPart& progress) {
  below.parent_of = std::move(groups.group_of);
  list_members(below, groups.count);
  if (options_.borders == Borders::locked) lock(below, groups.count);
  // One node is simplified to a quarter. Several all stop at one cost: forced to a quarter each, those with many locked
  // vertices would have errors many times the others', which every coarser node inherits.
  const bool is_last = groups.count == 1;
  const float most_cost = is_last ? std::numeric_limits<float>::max() : common_cost(below, groups.count);
  const std::size_t share = is_last ? wanted_share : smallest_share;

  std::vector<SimplifiedNode> results(groups.count);
  std::atomic<std::size_t> done = 0;
  for_each_task(
      groups.count, threads_, [&] { return Worker(*this, below); },
      [&](Worker& worker, std::size_t i) {
        const auto group = static_cast<std::uint32_t>(i);
        results[i] = worker.run(group, most_cost, members(group).size() / share);
        done += members(group).size();
      },
      [&] { progress.reach(done); });
  pass_on(results);
  return finish_level(mesh_, below, std::move(results), threads_);
}

void NodeSimplifier::lock(const LevelDraft& below, std::uint32_t group_count) {
  if (group_count == 1) {
    locked_ = lost_;
    return;
  }
  locked_ = shared_vertices(below.triangles, below.parent_of, mesh_.vertex_count(), threads_);
  for_each_id(locked_.size(), threads_, [&](VertexId v) { locked_[v] |= lost_[v]; });
}

void NodeSimplifier::list_members(const LevelDraft& below, std::uint32_t group_count) {
  first_member_.assign(group_count + 1, 0);
  for (const std::uint32_t group : below.parent_of) ++first_member_[group + 1];
  for (std::uint32_t group = 0; group < group_count; ++group) first_member_[group + 1] += first_member_[group];
  members_.resize(below.triangles.size());
  std::vector<std::uint32_t> next = first_member_;
  for (std::uint32_t t = 0; t < below.triangles.size(); ++t) members_[next[below.parent_of[t]]++] = t;
}

std::span<const std::uint32_t> NodeSimplifier::members(std::uint32_t group) const {
  return std::span<const std::uint32_t>(members_).subspan(first_member_[group],
                                                          first_member_[group + 1] - first_member_[group]);
}

// The median over groups, weighted by their size, of the cost at which a quarter is left; where there are many, over
// every so manieth.
float NodeSimplifier::common_cost(const LevelDraft& below, std::uint32_t group_count) const {
  const std::uint32_t step = std::max(1U, group_count / sampled_groups);
  const std::uint32_t samples = (group_count + step - 1) / step;
  std::vector<std::pair<float, std::size_t>> costs(samples);
  for_each_task(
      samples, threads_, [&] { return Worker(*this, below); },
      [&](Worker& worker, std::size_t i) {
        const auto group = static_cast<std::uint32_t>(i * step);
        costs[i] = {worker.sample(group), members(group).size()};
      },
      [] {});
  std::sort(costs.begin(), costs.end());
  std::size_t total = 0, below_median = 0;
  for (const auto& [cost, size] : costs) total += size;
  for (const auto& [cost, size] : costs) {
    below_median += size;
    if (2 * below_median >= total) return cost;
  }
  return costs.back().first;
}

// To the vertices that are left.
void NodeSimplifier::pass_on(const std::vector<SimplifiedNode>& results) {
  for (const SimplifiedNode& result : results) {
    for (const auto& [v, u] : result.merges) boxes_[u] = unite(boxes_[u], boxes_[v]);
    for (const VertexId v : result.lost) lost_[v] = 1;
  }
}

}  // namespace occlod::hlod
