#include "hlod/build/simplify_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <deque>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <system_error>
#include <utility>

#include "base/arithmetic.h"
#include "base/threads.h"
#include "hlod/build/finish_level.h"
#include "hlod/build/group_simplifier.h"
#include "hlod/build/group_triangles.h"
#include "hlod/build/level_draft.h"
#include "hlod/build/parts.h"
#include "occlod/base.h"
#include "splits/positions.h"
#include "splits/simplify_group.h"

namespace occlod::hlod {
namespace {

constexpr std::uint32_t groups_at_once = 256;  // groups whose results are in memory at a time
// Levels of more groups than are sampled anyway are shared by processes: in about so many parts, each of at least and
// at most so many groups. To hand a part out costs both sides some milliseconds, as much as to simplify a large group.
constexpr std::uint32_t parts_of_level = 64, least_groups_of_part = 16, most_groups_of_part = 32;

void remove_files(std::initializer_list<std::filesystem::path> files) {
  std::error_code ignored;  // the files do no harm
  for (const std::filesystem::path& file : files) std::filesystem::remove(file, ignored);
}

}  // namespace

// Takes groups out of the level below, one after another.
class NodeSimplifier::Gatherer {
 public:
  Gatherer(const NodeSimplifier& all, const LevelDraft& below) : all_(all), below_(below) {}

  // O(n log n) in the size of the group.
  [[nodiscard]] GroupInput run(std::uint32_t group) {
    const std::span<const std::uint32_t> members = all_.members(group);
    GroupInput input;
    TriangleMesh& mesh = input.mesh;
    vertices_.reset(3 * members.size());
    for (const std::uint32_t member : members) mesh.triangles.push_back(number(below_.triangles[member], vertices_));
    input.vertices.assign(vertices_.vertices().begin(), vertices_.vertices().end());
    if (!below_.corners.empty()) {
      seam_wedges_.reset(3 * members.size());
      for (const std::uint32_t member : members) mesh.corners.push_back(number(below_.corners[member], seam_wedges_));
      sort_wedges(input);
    } else {
      input.wedges = input.vertices;
    }
    copy_vertices(input);
    return input;
  }

 private:
  static Triangle number(const Triangle& t, LocalIds& ids) {
    const auto x = ids.add(t.x), y = ids.add(t.y), z = ids.add(t.z);
    return {x, y, z};
  }

  // Numbers the wedges as a TriangleMesh does: first one of each vertex, then the others ordered by vertex.
  void sort_wedges(GroupInput& input) {
    const std::size_t vertices = input.vertices.size(), wedges = seam_wedges_.vertices().size();
    input.wedges.assign(vertices, no_id);
    std::vector<std::uint32_t> local(wedges);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> extra;  // vertex, and one of its wedges
    for (std::uint32_t i = 0; i < wedges; ++i) {
      const WedgeId wedge = seam_wedges_.vertices()[i];
      const std::uint32_t v = vertices_.find(all_.mesh_.vertex_of(wedge));
      if (input.wedges[v] == no_id) {
        input.wedges[v] = wedge;
        local[i] = v;
      } else {
        extra.emplace_back(v, i);
      }
    }
    std::sort(extra.begin(), extra.end());
    for (const auto& [v, i] : extra) {
      local[i] = static_cast<std::uint32_t>(input.wedges.size());
      input.wedges.push_back(seam_wedges_.vertices()[i]);
      input.mesh.extra_wedges.push_back(v);
    }
    for (Triangle& t : input.mesh.corners) t = {local[t.x], local[t.y], local[t.z]};
    if (extra.empty()) input.mesh.corners.clear();
  }

  // Copies positions, attributes if they count, and what is known of vertices.
  void copy_vertices(GroupInput& input) const {
    const WedgeMesh& from = all_.mesh_;
    const auto copy = [](const auto& of_all, std::span<const std::uint32_t> ids, auto& to) {
      if (of_all.empty()) return;
      to.reserve(ids.size());
      for_each_id(ids.size(), 1, [&](std::uint32_t i) { to.push_back(of_all[ids[i]]); });
    };
    copy(from.positions, input.wedges, input.mesh.positions);
    copy(all_.locked_, input.vertices, input.locked);
    copy(all_.shared_, input.vertices, input.shared);
    copy(all_.boxes_, input.vertices, input.boxes);
    if (!all_.has_attributes_) return;
    copy(from.normals, input.wedges, input.mesh.normals);
    copy(from.colors, input.wedges, input.mesh.colors);
    copy(from.texture_coordinates, input.wedges, input.mesh.texture_coordinates);
    if (!from.wedge_features.empty()) return number_kinds(input);
    if (from.wedge_materials.empty()) return;
    for (const Triangle& t : input.mesh.wedge_triangles())
      input.mesh.triangle_materials.push_back(from.wedge_materials[input.wedges[t.x]]);
  }

  // Gives each pair of a material and a feature a material of its own, so that features keep apart as materials do.
  void number_kinds(GroupInput& input) const {
    const std::vector<Triangle>& triangles = input.mesh.wedge_triangles();
    const auto kind_of = [&](const Triangle& t) {
      return std::pair(all_.mesh_.material_of(input.wedges[t.x]), all_.mesh_.feature_of(input.wedges[t.x]));
    };
    std::vector<std::pair<MaterialId, FeatureId>> kinds;
    for (const Triangle& t : triangles)
      if (const auto kind = kind_of(t); kinds.empty() || kinds.back() != kind) kinds.push_back(kind);
    std::sort(kinds.begin(), kinds.end());
    kinds.erase(std::unique(kinds.begin(), kinds.end()), kinds.end());
    assert(kinds.size() <= std::numeric_limits<MaterialId>::max());  // nodes have fewer triangles
    for (const Triangle& t : triangles)
      input.mesh.triangle_materials.push_back(
          static_cast<MaterialId>(std::lower_bound(kinds.begin(), kinds.end(), kind_of(t)) - kinds.begin()));
  }

  const NodeSimplifier& all_;
  const LevelDraft& below_;
  LocalIds vertices_;     // of the input mesh, by local number
  LocalIds seam_wedges_;  // in the order in which they are met
};

NodeSimplifier::NodeSimplifier(WedgeMesh& mesh, const HlodBuildOptions& options, const Reduction& reduction,
                               unsigned threads, BuildJournal* journal)
    : mesh_(mesh),
      options_(options),
      reduction_(reduction),
      threads_(threads),
      journal_(journal),
      scale_(power_of_two_scale(mesh_.positions)),
      has_seams_(mesh_.has_seams()),
      has_attributes_(mesh_.has_wedge_attributes()),
      boxes_(mesh_.vertex_count()),
      locked_(mesh_.vertex_count(), 0),
      lost_(mesh_.vertex_count(), 0) {
  const auto& positions = mesh_.positions;
  for_each_id(boxes_.size(), threads, [&](VertexId v) { boxes_[v] = {positions[v], positions[v]}; });
  if (refits()) mesh_.extra_wedges.reserve(mesh_.extra_wedges.size() + mesh_.wedge_count() / 2);
}

LevelDraft NodeSimplifier::run(LevelDraft& below, TriangleGroups groups, const ProgressPart& progress) {
  below.parent_of = std::move(groups.group_of);
  ++level_;
  first_added_ = static_cast<WedgeId>(mesh_.wedge_count());
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
  if (options_.borders == Borders::locked)
    lock(below, group_count);
  else if (refits())
    shared_ = shared_vertices(below.triangles, below.parent_of, mesh_.vertex_count(), threads_);
  const GroupRules rules = rules_of(below, group_count);
  if (!options_.parts.folder.empty() && group_count > reduction_.sampled_groups)
    simplify_elsewhere(below, rules, first_group, group_count, level, progress);
  else
    simplify_here(below, rules, first_group, group_count, level, progress);
}

// Splits within nodes lead back to vertices that stay where they are.
bool NodeSimplifier::refits() const { return reduction_.keeps_bounds && options_.within == Within::geomorph; }

// A single node is simplified to the wanted share. Several all stop at one cost: if each were forced to it, those with
// many locked vertices would have errors many times the others', which every coarser node inherits.
GroupRules NodeSimplifier::rules_of(const LevelDraft& below, std::uint32_t group_count) const {
  GroupRules rules;
  rules.scale = scale_;
  rules.least_share = static_cast<float>(reduction_.wanted_share);
  rules.first_added = first_added_;
  rules.names_wedges = refits() || has_seams_ ? 1 : 0;
  rules.refits = refits() ? 1 : 0;
  rules.lattice_step = mesh_.lattice_step;
  rules.keeps_splits = options_.within == Within::splits ? 1 : 0;
  rules.measures = options_.error_bound == ErrorBound::measured ? 1 : 0;
  rules.keeps_bounds = reduction_.keeps_bounds ? 1 : 0;
  if (group_count == 1) return rules;
  rules.max_cost = common_cost(below, group_count, rules);
  rules.least_share = static_cast<float>(reduction_.least_share);
  return rules;
}

void NodeSimplifier::simplify_here(const LevelDraft& below, const GroupRules& rules, std::uint32_t first_group,
                                   std::uint32_t group_count, LevelBuilder& level, const ProgressPart& progress) {
  struct Worker {
    Gatherer gatherer;
    GroupSimplifier simplifier;
  };
  std::vector<SimplifiedNode> results(groups_at_once);
  std::size_t done_before = first_member_[first_group];
  for (std::uint32_t first = first_group; first < group_count; first += groups_at_once) {
    const std::uint32_t count = std::min(groups_at_once, group_count - first);
    std::atomic<std::size_t> done = done_before;
    for_each_task(
        count, threads_,
        [&] {
          return Worker{Gatherer(*this, below), {}};
        },
        [&](Worker& worker, std::size_t i) {
          const auto group = static_cast<std::uint32_t>(first + i);
          results[i] = worker.simplifier.run(worker.gatherer.run(group), rules);
          done += members(group).size();
        },
        [&] { progress.reach(done); });
    done_before = done;
    for (std::uint32_t i = 0; i < count; ++i) finish(results[i], level);
  }
}

// Writes tasks for other processes, and takes their results in order as they come. Results that an earlier build left
// are taken over.
void NodeSimplifier::simplify_elsewhere(const LevelDraft& below, const GroupRules& rules, std::uint32_t first_group,
                                        std::uint32_t group_count, LevelBuilder& level, const ProgressPart& progress) {
  struct Part {
    std::uint32_t first = 0, count = 0;
    std::filesystem::path task;
    std::uint64_t checksum = 0;
    bool is_started = false;
  };
  const HlodParts& parts = options_.parts;
  std::deque<Part> waiting;
  std::vector<SimplifiedNode> nodes;
  const auto take_first = [&] {
    const Part part = std::move(waiting.front());
    waiting.pop_front();
    if (part.is_started) parts.finish(part.task);
    const std::filesystem::path result = result_of(part.task);
    nodes.resize(part.count);
    if (!read_result(result, part.checksum, nodes))
      throw Error({result.string(), "", "is not there or not whole, though its groups were simplified",
                   "name a folder that all machines see"});
    for (std::uint32_t i = 0; i < part.count; ++i)
      if (part.first + i >= first_group) finish(nodes[i], level);  // the journal had the others
    remove_files({part.task, result});
    progress.reach(first_member_[part.first + part.count]);
  };
  const std::uint32_t size = std::clamp(group_count / parts_of_level, least_groups_of_part, most_groups_of_part);
  for (std::uint32_t first = first_group / size * size; first < group_count; first += size) {
    Part part{first, std::min(size, group_count - first), parts.folder / fmt::format("level-{}-{}", level_, first)};
    part.task += task_extension;
    const PartTask task = pack_task(rules, gather(below, first, part.count));
    part.checksum = task.checksum;
    nodes.resize(part.count);
    part.is_started = !read_result(result_of(part.task), part.checksum, nodes);
    if (part.is_started) {
      write_task(part.task, task);
      parts.start(part.task);
    }
    waiting.push_back(std::move(part));
    while (!waiting.empty() && std::filesystem::exists(result_of(waiting.front().task))) take_first();
  }
  while (!waiting.empty()) take_first();
}

std::vector<GroupInput> NodeSimplifier::gather(const LevelDraft& below, std::uint32_t first,
                                               std::uint32_t count) const {
  std::vector<GroupInput> groups(count);
  for_each_task(
      count, threads_, [&] { return Gatherer(*this, below); },
      [&](Gatherer& gatherer, std::size_t i) { groups[i] = gatherer.run(static_cast<std::uint32_t>(first + i)); },
      [] {});
  return groups;
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

// Returns the cost at which the wanted share is left: the median over groups, weighted by size. Where there are many
// groups, only every `step`-th is sampled.
float NodeSimplifier::common_cost(const LevelDraft& below, std::uint32_t group_count, const GroupRules& rules) const {
  const std::uint32_t step = std::max(1U, group_count / reduction_.sampled_groups);
  const std::uint32_t samples = (group_count + step - 1) / step;
  std::vector<std::pair<float, std::size_t>> costs(samples);
  for_each_task(
      samples, threads_, [&] { return Gatherer(*this, below); },
      [&](Gatherer& gatherer, std::size_t i) {
        const auto group = static_cast<std::uint32_t>(i * step);
        costs[i] = {GroupSimplifier::cost_of(gatherer.run(group), rules), members(group).size()};
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

// Notes a node that was not in the journal, and joins it to the level.
void NodeSimplifier::finish(SimplifiedNode& result, LevelBuilder& level) {
  if (journal_ != nullptr) journal_->append(result);
  join(result, level);
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
  const auto offset = static_cast<WedgeId>(mesh_.wedge_count()) - first_added_;
  for (const NewWedge& wedge : result.added) mesh_.add(wedge);
  const auto move = [&](WedgeId& wedge) { wedge += wedge < first_added_ ? 0 : offset; };
  for (Triangle& t : result.corners)
    for (int k = 0; k < 3; ++k) move(t[k]);
  for (Merge& merge : result.merges) {
    move(merge.v);
    move(merge.u);
  }
  for (WedgeId& wedge : result.bare_targets) move(wedge);
  for (WedgeId& wedge : result.within.wedges) move(wedge);
}

// Applies the losses once the level is finished, because nodes share vertices.
void NodeSimplifier::pass_on(const LevelDraft& level) {
  for_each_id(level.merges.size(), 1, [&](std::uint32_t i) {
    const auto& [v, u] = level.merges[i];
    Box& box = boxes_[mesh_.vertex_of(u)];
    box = unite(box, boxes_[mesh_.vertex_of(v)]);
  });
  for_each_id(mesh_.wedge_count() - first_added_, 1, [&](std::uint32_t i) {
    const WedgeId wedge = first_added_ + i;
    const glm::vec3& p = mesh_.positions[wedge];
    Box& box = boxes_[mesh_.vertex_of(wedge)];
    box = unite(box, {p, p});
  });
  for_each_id(grown_.size(), 1, [&](std::uint32_t i) {
    Box& box = boxes_[grown_[i].vertex];
    box = unite(box, grown_[i].box);
  });
  for_each_id(losses_.size(), 1, [&](std::uint32_t i) { lost_[losses_[i]] = 1; });
  grown_.clear();
  losses_.clear();
}

}  // namespace occlod::hlod
