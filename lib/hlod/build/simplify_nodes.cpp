#include "hlod/build/simplify_nodes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <limits>
#include <utility>

#include "base/arithmetic.h"
#include "base/threads.h"
#include "hlod/build/finish_level.h"
#include "hlod/build/group_triangles.h"
#include "hlod/build/level_draft.h"
#include "splits/group_error.h"
#include "splits/positions.h"
#include "splits/simplify_group.h"

namespace occlod::hlod {
namespace {

constexpr std::size_t wanted_share = 4;    // target: a quarter of its input's triangles
constexpr std::size_t smallest_share = 8;  // minimum: an eighth
constexpr std::uint32_t sampled_groups = 32;
constexpr std::uint32_t groups_at_once = 512;  // groups whose results are in memory at a time

}  // namespace

// Simplifies one group after another.
class NodeSimplifier::Worker {
 public:
  Worker(const NodeSimplifier& all, const LevelDraft& below) : all_(all), below_(below) {}

  // Returns the cost at which a quarter of the group's triangles is left.
  float sample(std::uint32_t group) {
    gather(group);
    return simplify(std::numeric_limits<float>::max(), all_.members(group).size() / wanted_share).cost;
  }

  SimplifiedNode run(std::uint32_t group, float max_cost, std::size_t min_triangles) {
    gather(group);
    const SimplifiedGroup simplified = simplify(max_cost, min_triangles);
    SimplifiedNode result;
    result.error = simplified.error;
    result.guaranteed_error = all_.options_.error_bound == ErrorBound::measured ? measured_error(input_, simplified)
                                                                                : simplified.guaranteed_error;
    result.box = box();
    for (const Triangle& t : simplified.triangles) result.triangles.push_back(global(t, vertices_.vertices()));
    for (const AddedWedge& added : simplified.added) {
      result.added.push_back({vertices_.vertices()[added.vertex], wedges_[added.attributes]});
      wedges_.push_back(static_cast<WedgeId>(all_.mesh_.wedge_count() + result.added.size() - 1));
    }
    if (all_.mesh_.has_seams())
      for (const Triangle& t : simplified.corners.empty() ? simplified.triangles : simplified.corners)
        result.corners.push_back(global(t, wedges_));
    list_merges(simplified, result);
    list_lost(simplified, result);
    list_vanished(simplified, result);
    if (!simplified.collapses.empty() && wedges_.size() <= stays && can_replay(simplified))
      keep_splits(simplified, result.within);
    return result;
  }

 private:
  void gather(std::uint32_t group) {
    group_ = group;
    const std::span<const std::uint32_t> members = all_.members(group);
    input_ = {};
    vertices_.reset(3 * members.size());
    for (const std::uint32_t member : members) input_.triangles.push_back(number(below_.triangles[member], vertices_));
    if (all_.mesh_.has_seams()) {
      seam_wedges_.reset(3 * members.size());
      for (const std::uint32_t member : members) input_.corners.push_back(number(below_.corners[member], seam_wedges_));
    }
    if (all_.mesh_.has_seams())
      sort_wedges();
    else
      wedges_.assign(vertices_.vertices().begin(), vertices_.vertices().end());
    copy_vertices();
  }

  static Triangle number(const Triangle& t, LocalIds& ids) {
    const auto x = ids.add(t.x), y = ids.add(t.y), z = ids.add(t.z);
    return {x, y, z};
  }

  static Triangle global(const Triangle& t, std::span<const std::uint32_t> ids) {
    return {ids[t.x], ids[t.y], ids[t.z]};
  }

  // Numbers the wedges as a TriangleMesh does: first one of each vertex, then the others ordered by vertex.
  void sort_wedges() {
    const std::size_t vertices = vertices_.vertices().size(), wedges = seam_wedges_.vertices().size();
    wedges_.assign(vertices, no_id);
    std::vector<std::uint32_t> local(wedges);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> extra;  // vertex, and one of its wedges
    for (std::uint32_t i = 0; i < wedges; ++i) {
      const WedgeId wedge = seam_wedges_.vertices()[i];
      const std::uint32_t v = vertices_.find(all_.mesh_.vertex_of(wedge));
      if (wedges_[v] == no_id) {
        wedges_[v] = wedge;
        local[i] = v;
      } else {
        extra.emplace_back(v, i);
      }
    }
    std::sort(extra.begin(), extra.end());
    for (const auto& [v, i] : extra) {
      local[i] = static_cast<std::uint32_t>(wedges_.size());
      wedges_.push_back(seam_wedges_.vertices()[i]);
      input_.extra_wedges.push_back(v);
    }
    for (Triangle& t : input_.corners) t = global(t, local);
    if (extra.empty()) input_.corners.clear();
  }

  // Copies positions, and attributes if they count.
  void copy_vertices() {
    const WedgeMesh& from = all_.mesh_;
    const auto copy = [&](const auto& of_all, auto& to) {
      if (of_all.empty()) return;
      for_each_id(wedges_.size(), 1, [&](std::uint32_t i) { to.push_back(of_all[wedges_[i]]); });
    };
    copy(from.positions, input_.positions);
    locked_.clear();
    const std::span<const VertexId> vertices = vertices_.vertices();
    for_each_id(vertices.size(), 1, [&](std::uint32_t i) { locked_.push_back(all_.locked_[vertices[i]]); });
    if (!from.has_wedge_attributes()) return;
    copy(from.normals, input_.normals);
    copy(from.colors, input_.colors);
    copy(from.texture_coordinates, input_.texture_coordinates);
    if (!from.wedge_features.empty()) return number_kinds();
    if (from.wedge_materials.empty()) return;
    for (const Triangle& t : input_.wedge_triangles())
      input_.triangle_materials.push_back(from.wedge_materials[wedges_[t.x]]);
  }

  // Gives each pair of a material and a feature a material of its own, so that features keep apart as materials do.
  void number_kinds() {
    const auto kind_of = [&](const Triangle& t) {
      return std::pair(all_.mesh_.material_of(wedges_[t.x]), all_.mesh_.feature_of(wedges_[t.x]));
    };
    kinds_.clear();
    for (const Triangle& t : input_.wedge_triangles())
      if (const auto kind = kind_of(t); kinds_.empty() || kinds_.back() != kind) kinds_.push_back(kind);
    std::sort(kinds_.begin(), kinds_.end());
    kinds_.erase(std::unique(kinds_.begin(), kinds_.end()), kinds_.end());
    assert(kinds_.size() <= std::numeric_limits<MaterialId>::max());  // nodes have fewer triangles
    for (const Triangle& t : input_.wedge_triangles())
      input_.triangle_materials.push_back(
          static_cast<MaterialId>(std::lower_bound(kinds_.begin(), kinds_.end(), kind_of(t)) - kinds_.begin()));
  }

  [[nodiscard]] SimplifiedGroup simplify(float max_cost, std::size_t min_triangles) const {
    return simplify_group(input_, locked_,
                          {all_.scale_, build_weights.boundary, max_cost, min_triangles,
                           all_.options_.within == Within::splits, build_weights.attributes});
  }

  [[nodiscard]] Box box() const {
    const std::span<const VertexId> vertices = vertices_.vertices();
    Box box = all_.boxes_[vertices[0]];
    for_each_id(vertices.size(), 1, [&](std::uint32_t i) { box = unite(box, all_.boxes_[vertices[i]]); });
    return box;
  }

  void list_merges(const SimplifiedGroup& simplified, SimplifiedNode& result) {
    used_.assign(wedges_.size(), 0);
    for (const Triangle& t : simplified.corners.empty() ? simplified.triangles : simplified.corners)
      used_[t.x] = used_[t.y] = used_[t.z] = 1;
    for (std::uint32_t w = 0; w < wedges_.size(); ++w) {
      const std::uint32_t into = simplified.merged_into[w];
      if (into == w) continue;
      result.merges.push_back({wedges_[w], wedges_[into]});
      if (used_[into] == 0) result.bare_targets.push_back(wedges_[into]);
    }
    std::sort(result.bare_targets.begin(), result.bare_targets.end());
    result.bare_targets.erase(std::unique(result.bare_targets.begin(), result.bare_targets.end()),
                              result.bare_targets.end());
  }

  void list_lost(const SimplifiedGroup& simplified, SimplifiedNode& result) {
    used_.assign(locked_.size(), 0);
    for (const Triangle& t : simplified.triangles) used_[t.x] = used_[t.y] = used_[t.z] = 1;
    for (std::uint32_t v = 0; v < used_.size(); ++v)
      if (locked_[v] != 0 && used_[v] == 0) result.lost.push_back(vertices_.vertices()[v]);
  }

  // Lists the boxes of the group's triangles that are gone and stood for by no triangle that is left. Those that were
  // folded onto a corner or an edge of one need no room: the boxes of its vertices hold theirs.
  void list_vanished(const SimplifiedGroup& simplified, SimplifiedNode& result) {
    note_left(simplified);
    grown_.clear();
    for (const std::uint32_t member : all_.members(group_)) {
      const Triangle& global_ids = below_.triangles[member];
      Box box = all_.boxes_[global_ids.x];
      Triangle own;
      for (int k = 0; k < 3; ++k) {
        box = unite(box, all_.boxes_[global_ids[k]]);
        own[k] = vertices_.find(global_ids[k]);
      }
      const Triangle image = image_of(own, simplified);
      if (is_left(sorted(image))) continue;
      const int heir = used_[image.x] != 0 ? 0 : used_[image.y] != 0 ? 1 : 2;
      if (used_[image[heir]] != 0)
        grown_.push_back({image[heir], box});
      else
        grow(result.vanished, box);
    }
    std::sort(grown_.begin(), grown_.end(), [](const GrownBox& a, const GrownBox& b) { return a.vertex < b.vertex; });
    for (const GrownBox& grown : grown_) {
      const VertexId vertex = vertices_.vertices()[grown.vertex];
      if (result.grown.empty() || result.grown.back().vertex != vertex)
        result.grown.push_back({vertex, grown.box});
      else
        result.grown.back().box = unite(result.grown.back().box, grown.box);
    }
  }

  // Notes the corners, edges and triangles that are left.
  void note_left(const SimplifiedGroup& simplified) {
    left_.clear();
    left_edges_.clear();
    used_.assign(locked_.size(), 0);
    for (const Triangle& t : simplified.triangles) {
      const auto [a, b, c] = left_.emplace_back(sorted(t));
      left_edges_.insert(left_edges_.end(), {{a, b}, {a, c}, {b, c}});
      used_[a] = used_[b] = used_[c] = 1;
    }
    std::sort(left_.begin(), left_.end());
    std::sort(left_edges_.begin(), left_edges_.end());
  }

  // Returns whether a triangle that is left has these corners, given in order, of which some may be equal.
  [[nodiscard]] bool is_left(const std::array<std::uint32_t, 3>& corners) const {
    const auto [a, b, c] = corners;
    if (a == c) return used_[a] != 0;
    if (a == b || b == c) return std::binary_search(left_edges_.begin(), left_edges_.end(), std::pair(a, c));
    return std::binary_search(left_.begin(), left_.end(), corners);
  }

  // Returns the local vertex of a wedge, which simplification may have added.
  [[nodiscard]] VertexId vertex_of(WedgeId wedge, const SimplifiedGroup& simplified) const {
    const std::size_t wedges = input_.wedge_count();
    return wedge < wedges ? input_.vertex_of(wedge) : simplified.added[wedge - wedges].vertex;
  }

  // Returns the local vertices into which the corners of a triangle of the input were merged.
  [[nodiscard]] Triangle image_of(const Triangle& t, const SimplifiedGroup& simplified) const {
    Triangle image;
    for (int k = 0; k < 3; ++k) image[k] = vertex_of(simplified.merged_into[t[k]], simplified);
    return image;
  }

  // Returns the corners, the smallest first.
  static std::array<std::uint32_t, 3> sorted(const Triangle& t) {
    std::array<std::uint32_t, 3> corners{t.x, t.y, t.z};
    std::sort(corners.begin(), corners.end());
    return corners;
  }

  // Returns whether merging all triangles of the group at once leaves as many as its collapses, one after the other,
  // did. Only where both sides of a sheet were folded onto other faces does the order matter.
  [[nodiscard]] bool can_replay(const SimplifiedGroup& simplified) const {
    std::vector<Triangle> merged, before, none;
    for (const Triangle& t : input_.triangles) {
      const Triangle image = image_of(t, simplified);
      if (image.x == image.y || image.y == image.z || image.z == image.x) continue;
      merged.push_back(image);
      before.push_back(t);
    }
    cancel_folded(merged, none, before);
    return merged.size() == simplified.triangles.size();
  }

  void keep_splits(const SimplifiedGroup& simplified, SplitsDraft& within) const {
    const auto own = [](std::uint32_t local) { return static_cast<std::uint16_t>(local); };
    within.wedges = wedges_;
    for (const Triangle& t : input_.wedge_triangles())
      for (int k = 0; k < 3; ++k) within.indices.push_back(own(t[k]));
    for (const GroupCollapse& c : simplified.collapses) within.splits.push_back({own(c.v), own(c.u), c.error});
  }

  const NodeSimplifier& all_;
  const LevelDraft& below_;
  std::uint32_t group_ = 0;
  LocalIds vertices_;     // of the input mesh, by local number
  LocalIds seam_wedges_;  // in the order in which they are met
  TriangleMesh input_;
  std::vector<WedgeId> wedges_;  // by local number, after simplification with those added
  std::vector<std::uint8_t> locked_, used_;
  std::vector<std::pair<MaterialId, FeatureId>> kinds_;              // of triangles, in order
  std::vector<std::array<std::uint32_t, 3>> left_;                   // the remaining triangles, in order
  std::vector<std::pair<std::uint32_t, std::uint32_t>> left_edges_;  // of them, in order
  std::vector<GrownBox> grown_;                                      // by local vertex
};

NodeSimplifier::NodeSimplifier(WedgeMesh& mesh, const HlodBuildOptions& options, unsigned threads,
                               BuildJournal* journal)
    : mesh_(mesh),
      options_(options),
      threads_(threads),
      journal_(journal),
      scale_(power_of_two_scale(mesh_.positions)),
      boxes_(mesh_.vertex_count()),
      locked_(mesh_.vertex_count(), 0),
      lost_(mesh_.vertex_count(), 0) {
  const LargeVector<glm::vec3>& positions = mesh_.positions;
  for_each_id(boxes_.size(), threads, [&](VertexId v) { boxes_[v] = {positions[v], positions[v]}; });
}

LevelDraft NodeSimplifier::run(LevelDraft& below, TriangleGroups groups, const ProgressPart& progress) {
  below.parent_of = std::move(groups.group_of);
  LevelBuilder level(mesh_, below, groups.count, threads_);
  std::uint32_t first = 0;
  for (SimplifiedNode node; first < groups.count && journal_ != nullptr && journal_->take(node); ++first) {
    join(node, level);
    progress.reach(below.triangles.size() / groups.count * first);
  }
  if (first < groups.count) simplify(below, first, groups.count, level, progress);
  LevelDraft result = level.finish();
  pass_on(result);
  return result;
}

// Simplifies the groups from `first_group` on.
void NodeSimplifier::simplify(const LevelDraft& below, std::uint32_t first_group, std::uint32_t group_count,
                              LevelBuilder& level, const ProgressPart& progress) {
  list_members(below, group_count);
  if (options_.borders == Borders::locked) lock(below, group_count);
  // A single node is simplified to a quarter. Several all stop at one cost: if each were forced to a quarter, those
  // with many locked vertices would have errors many times the others', which every coarser node inherits.
  const bool is_last = group_count == 1;
  const float max_cost = is_last ? std::numeric_limits<float>::max() : common_cost(below, group_count);
  const std::size_t share = is_last ? wanted_share : smallest_share;

  std::vector<SimplifiedNode> results(groups_at_once);
  std::size_t done_before = first_member_[first_group];
  for (std::uint32_t first = first_group; first < group_count; first += groups_at_once) {
    const std::uint32_t count = std::min(groups_at_once, group_count - first);
    std::atomic<std::size_t> done = done_before;
    for_each_task(
        count, threads_, [&] { return Worker(*this, below); },
        [&](Worker& worker, std::size_t i) {
          const auto group = static_cast<std::uint32_t>(first + i);
          results[i] = worker.run(group, max_cost, members(group).size() / share);
          done += members(group).size();
        },
        [&] { progress.reach(done); });
    done_before = done;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (journal_ != nullptr) journal_->append(results[i]);
      join(results[i], level);
    }
  }
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
  for_each_id(below.parent_of.size(), 1, [&](std::uint32_t t) { ++first_member_[below.parent_of[t] + 1]; });
  for (std::uint32_t group = 0; group < group_count; ++group) first_member_[group + 1] += first_member_[group];
  members_.resize(below.triangles.size());
  std::vector<std::uint32_t> next = first_member_;
  for_each_id(below.triangles.size(), 1, [&](std::uint32_t t) { members_[next[below.parent_of[t]]++] = t; });
}

std::span<const std::uint32_t> NodeSimplifier::members(std::uint32_t group) const {
  return std::span<const std::uint32_t>(members_).subspan(first_member_[group],
                                                          first_member_[group + 1] - first_member_[group]);
}

// Returns the cost at which a quarter is left: the median over groups, weighted by size. Where there are many groups,
// only every `step`-th is sampled.
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

void NodeSimplifier::join(SimplifiedNode& result, LevelBuilder& level) {
  make_room();
  note(result);
  level.append(result);
}

// Records what a node has lost and added. Added wedges are numbered consecutively over all nodes.
void NodeSimplifier::note(SimplifiedNode& result) {
  losses_.insert(losses_.end(), result.lost.begin(), result.lost.end());
  grown_.insert(grown_.end(), result.grown.begin(), result.grown.end());
  if (result.added.empty()) return;
  const auto first = static_cast<WedgeId>(mesh_.wedge_count()), offset = static_cast<WedgeId>(added_.size());
  added_.insert(added_.end(), result.added.begin(), result.added.end());
  const auto move = [&](WedgeId& wedge) { wedge += wedge < first ? 0 : offset; };
  for (Triangle& t : result.corners)
    for (int k = 0; k < 3; ++k) move(t[k]);
  for (Merge& merge : result.merges) {
    move(merge.v);
    move(merge.u);
  }
  for (WedgeId& wedge : result.bare_targets) move(wedge);
  for (WedgeId& wedge : result.within.wedges) move(wedge);
}

// Adds the wedges to the mesh and applies the losses once the level is finished, because nodes share vertices.
void NodeSimplifier::pass_on(const LevelDraft& level) {
  for (const auto& [vertex, like] : added_) mesh_.add(vertex, like);
  for_each_id(level.merges.size(), 1, [&](std::uint32_t i) {
    const auto& [v, u] = level.merges[i];
    Box& box = boxes_[mesh_.vertex_of(u)];
    box = unite(box, boxes_[mesh_.vertex_of(v)]);
  });
  for_each_id(grown_.size(), 1, [&](std::uint32_t i) {
    Box& box = boxes_[grown_[i].vertex];
    box = unite(box, grown_[i].box);
  });
  for_each_id(losses_.size(), 1, [&](std::uint32_t i) { lost_[losses_[i]] = 1; });
  added_.clear();
  grown_.clear();
  losses_.clear();
}

}  // namespace occlod::hlod
