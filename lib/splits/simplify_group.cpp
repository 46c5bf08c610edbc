#include "splits/simplify_group.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "splits/build_progress.h"
#include "splits/collapse_worker.h"
#include "splits/refit_group.h"
#include "splits/simplify_state.h"

namespace occlod {
namespace {

// Records the wedge into which one wedge was merged.
struct Merge {
  WedgeId from = no_id, into = no_id;
};

// Numbers wedges by their vertices and the input wedges whose attributes they have, and tracks their merges.
class GroupWedges {
 public:
  explicit GroupWedges(const TriangleMesh& mesh) : mesh_(mesh) {
    if (mesh.extra_wedges.empty()) return;
    wedges_at_.resize(mesh.vertex_count());
    for (WedgeId w = 0; w < mesh.wedge_count(); ++w) wedges_at_[mesh.vertex_of(w)].push_back(w);
  }

  // Returns the number of a wedge; assigns a new one when it has none. Without extra wedges it is the vertex.
  WedgeId number(VertexId vertex, WedgeId attributes) {
    if (wedges_at_.empty() || mesh_.vertex_of(attributes) == vertex) return attributes;
    const std::uint64_t key = std::uint64_t{vertex} << 32U | attributes;
    const auto [found, is_new] = numbers_.emplace(key, static_cast<WedgeId>(mesh_.wedge_count() + added_.size()));
    if (is_new) {
      added_.push_back({vertex, attributes});
      wedges_at_[vertex].push_back(found->second);
    }
    return found->second;
  }

  // Moves all wedges of v into u. `merges` lists where its corners went; the other wedges of v no longer have corners.
  void collapse(VertexId v, VertexId u, std::span<const AttributeStar::WedgeMerge> merges) {
    const std::size_t first = merges_.size();
    first_merge_.push_back(first);
    if (wedges_at_.empty()) {
      merges_.push_back({v, u});
      return;
    }
    for (const AttributeStar::WedgeMerge& merge : merges) {
      merges_.push_back({number(v, merge.wedge), number(u, merge.into)});
      is_split_ = is_split_ || merge.is_split;
    }
    const auto begin = merges_.begin() + static_cast<std::ptrdiff_t>(first);
    const std::vector<Merge> with_corners(begin, merges_.end());
    for (const WedgeId wedge : wedges_at_[v])
      if (std::ranges::find(with_corners, wedge, &Merge::from) == with_corners.end())
        merges_.push_back({wedge, with_corners.empty() ? u : with_corners.front().into});
  }

  // Returns the merges of the i-th collapse, in the order in which collapses were made.
  [[nodiscard]] std::span<const Merge> merges_of(std::size_t i) const {
    const std::size_t end = i + 1 < first_merge_.size() ? first_merge_[i + 1] : merges_.size();
    return std::span(merges_).subspan(first_merge_[i], end - first_merge_[i]);
  }
  [[nodiscard]] const std::vector<AddedWedge>& added() const { return added_; }
  // Returns whether corners with one wedge went to several.
  [[nodiscard]] bool is_split() const { return is_split_; }

  // A wedge's target is merged later or never, so when the collapses are visited backwards, every target is already
  // final.
  [[nodiscard]] std::vector<WedgeId> final_targets() const {
    std::vector<WedgeId> target(mesh_.wedge_count() + added_.size());
    std::iota(target.begin(), target.end(), 0U);
    for (std::size_t i = merges_.size(); i-- > 0;) target[merges_[i].from] = target[merges_[i].into];
    return target;
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<Merge> merges_;
  std::vector<std::size_t> first_merge_;                // per collapse
  std::vector<std::vector<WedgeId>> wedges_at_;         // per vertex; empty without extra wedges
  std::unordered_map<std::uint64_t, WedgeId> numbers_;  // of added wedges, by vertex and attributes
  std::vector<AddedWedge> added_;
  bool is_split_ = false;
};

// Returns the error of each collapse, including its attribute deviation where attributes count.
std::vector<float> errors_of(std::span<Collapse* const> collapses, const BlockRecord& record, bool with_attributes) {
  std::vector<float> errors;
  for (std::size_t i = 0; i < collapses.size(); ++i)
    errors.push_back(with_attributes ? std::max(collapses[i]->error, record.attribute_errors[i]) : collapses[i]->error);
  return errors;
}

// Returns a bound on the distance of a face from the input: each corner has that of its worst face so far.
float bound_of(const SimplifyState& state, const Triangle& t) {
  const float error = std::min({state.records[t.x].error, state.records[t.y].error, state.records[t.z].error});
  return scaled_up(error, (1.0F + 1e-5F) / state.scale);
}

// Lists the remaining faces.
void list_faces(const SimplifyState& state, bool has_seams, bool lists_bounds, GroupWedges& wedges,
                SimplifiedGroup& result) {
  std::vector<StarFace> before;  // earlier faces at the same vertex
  VertexId v = no_id;
  for (const LevelFace& face : state.mesh.faces()) {
    result.triangles.push_back(face.corners);
    if (lists_bounds) result.bounds.push_back(face.made_by == no_id ? 0.0F : bound_of(state, face.corners));
    if (!has_seams) continue;
    if (face.corners.x != v) before.clear();
    v = face.corners.x;
    const StarFace of_v{face.corners.y, face.corners.z, face.made_by};
    const auto rank = static_cast<std::size_t>(std::count(before.begin(), before.end(), of_v));
    const Triangle attributes = state.attributes->corners.wedges(v, of_v, rank);
    result.corners.emplace_back(wedges.number(face.corners.x, attributes.x),
                                wedges.number(face.corners.y, attributes.y),
                                wedges.number(face.corners.z, attributes.z));
    before.push_back(of_v);
  }
}

// Makes errors monotone. A collapse depends on those that made faces around its vertex or need that vertex as a corner:
// those that ended faces at it. A collapse that folds faces onto others depends on everything that happened at any
// corner of the faces it ends.
std::vector<GroupCollapse> saturated(std::span<Collapse* const> collapses, std::span<const float> errors,
                                     const GroupWedges& wedges, std::size_t vertex_count) {
  std::vector<float> reached(vertex_count, 0.0F);  // the largest error so far at each vertex
  std::vector<std::pair<float, std::size_t>> placed;
  for (std::size_t i = 0; i < collapses.size(); ++i) {
    const Collapse* const c = collapses[i];
    const auto for_each_corner = [&](const auto& visit) {
      for (std::uint32_t slot = 0; slot < c->ended_count(); ++slot)
        for (int k = 0; k < 3; ++k) visit(c->ended(slot)[k]);
    };
    float error = std::max(errors[i], reached[c->v]);
    if (!c->is_fan()) for_each_corner([&](VertexId w) { error = std::max(error, reached[w]); });
    for_each_corner([&](VertexId w) { reached[w] = std::max(reached[w], error); });
    reached[c->u] = std::max(reached[c->u], error);
    placed.emplace_back(error, i);
  }
  std::sort(placed.begin(), placed.end(), std::greater<>());
  std::vector<GroupCollapse> result;
  for (const auto& [error, i] : placed)
    for (const Merge& merge : wedges.merges_of(i)) result.push_back({merge.from, merge.into, error});
  return result;
}

}  // namespace

SimplifiedGroup simplify_group(const TriangleMesh& mesh, std::span<const std::uint8_t> locked,
                               const GroupTarget& target) {
  assert(locked.empty() || locked.size() == mesh.vertex_count());
  static const std::function<bool(double)> nobody;
  BuildProgress progress(nobody);
  const bool has_seams = !mesh.extra_wedges.empty();
  const SimplifySetup setup{.boundary_weight = target.boundary_weight,
                            .threads = 1,
                            .scale = target.scale,
                            .locked = locked,
                            .keeps_attributes = has_seams || target.attribute_weight > 0.0,
                            .attribute_weight = target.attribute_weight,
                            .keeps_wedge_merges = has_seams,
                            .keeps_collapses = target.keeps_bounds || target.lists_bounds || target.keeps_collapses};
  SimplifyState state(mesh, setup, ProgressPart{progress});
  std::vector<VertexId> all(mesh.vertex_count());
  std::iota(all.begin(), all.end(), 0U);

  CollapseRecords records;
  records.resize(1, all.size());
  CollapseWorker worker(state, records);
  const std::size_t count = mesh.triangle_count();
  const Block block{all, 0, 0, target.max_cost, count - std::min(count, target.min_triangles)};
  worker.run(block, [](std::size_t) { return true; });
  const BlockRecord& record = records[0];
  const std::span<Collapse* const> collapses = records.collapses(0);

  SimplifiedGroup result;
  const bool has_attributes = state.attributes != nullptr && target.attribute_weight > 0.0;
  const std::vector<float> errors = errors_of(collapses, record, has_attributes);
  result.error = record.largest_error;
  for (const float error : errors) result.error = std::max(result.error, error);
  GroupWedges wedges(mesh);
  std::size_t next = 0;
  const auto add_merge = [&](VertexId v, VertexId u) {
    const std::size_t first = next;
    while (next < record.wedge_merges.size() && record.wedge_merges[next].v == v) ++next;
    wedges.collapse(v, u, std::span(record.wedge_merges).subspan(first, next - first));
  };
  for (const auto& [v, u] : record.merges) add_merge(v, u);
  for (const Collapse* const collapse : collapses) {
    add_merge(collapse->v, collapse->u);
    result.guaranteed_error = std::max(result.guaranteed_error, collapse->guaranteed_error);
  }
  result.cost = record.largest_cost;
  for (const float rank : record.ranks) result.cost = std::max(result.cost, rank);
  list_faces(state, has_seams, target.lists_bounds, wedges, result);
  result.merged_into = wedges.final_targets();
  if (target.keeps_collapses && !wedges.is_split())
    result.collapses = saturated(collapses, errors, wedges, mesh.vertex_count());
  result.added = wedges.added();
  if (target.refits)
    refit_group(
        {mesh, locked, target, collapses,
         has_attributes ? std::span<const float>(record.attribute_errors) : std::span<const float>(), record.torn},
        state, result);
  return result;
}

}  // namespace occlod
