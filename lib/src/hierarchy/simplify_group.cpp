#include "simplify_group.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <numeric>
#include <utility>

#include "build_progress.h"
#include "collapse_worker.h"
#include "simplify_state.h"

namespace occlod {
namespace {

// Follows each vertex to where it ended up. Whatever a vertex is merged into is merged later or never, so going through
// the collapses backwards, targets are final when they are looked at.
std::vector<VertexId> final_targets(std::span<Collapse* const> collapses, std::size_t vertex_count) {
  std::vector<VertexId> target(vertex_count);
  std::iota(target.begin(), target.end(), 0U);
  for (std::size_t i = collapses.size(); i-- > 0;) target[collapses[i]->v] = target[collapses[i]->u];
  return target;
}

// A collapse comes after those that made faces around its vertex, or need it as a corner: those that ended faces at
// that vertex. One that folds faces onto others comes after whatever happened at any corner of what it ends.
std::vector<GroupCollapse> saturated(std::span<Collapse* const> collapses, std::size_t vertex_count) {
  std::vector<float> reached(vertex_count, 0.0F);  // the largest error of what happened at each vertex
  std::vector<std::pair<GroupCollapse, std::size_t>> placed;
  for (const Collapse* const c : collapses) {
    const auto for_each_corner = [&](const auto& visit) {
      for (std::uint32_t slot = 0; slot < c->ended_count(); ++slot)
        for (int k = 0; k < 3; ++k) visit(c->ended(slot)[k]);
    };
    float error = std::max(c->error, reached[c->v]);
    if (!c->is_fan()) for_each_corner([&](VertexId w) { error = std::max(error, reached[w]); });
    for_each_corner([&](VertexId w) { reached[w] = std::max(reached[w], error); });
    reached[c->u] = std::max(reached[c->u], error);
    placed.push_back({{c->v, c->u, error}, placed.size()});
  }
  std::sort(placed.begin(), placed.end(), [](const auto& a, const auto& b) {
    return a.first.error != b.first.error ? a.first.error > b.first.error : a.second > b.second;
  });
  std::vector<GroupCollapse> result;
  for (const auto& [collapse, place] : placed) result.push_back(collapse);
  return result;
}

}  // namespace

SimplifiedGroup simplify_group(const TriangleMesh& mesh, std::span<const std::uint8_t> locked,
                               const GroupTarget& target) {
  assert(locked.empty() || locked.size() == mesh.vertex_count());
  static const std::function<bool(double)> nobody;
  BuildProgress progress(nobody);
  SimplifyState state(mesh, {target.boundary_weight, 1, target.scale, locked}, ProgressPart{progress});
  std::vector<VertexId> all(mesh.vertex_count());
  std::iota(all.begin(), all.end(), 0U);
  for (const VertexId v : all) state.turns[v].place = v;

  CollapseRecords records;
  records.resize(1);
  CollapseWorker worker(state, records);
  const std::size_t count = mesh.triangle_count();
  const Block block{all, 0, 0, target.most_cost, count - std::min(count, target.least_triangles)};
  worker.run(block, [](std::size_t) { return true; });
  const BlockRecord& record = records[0];

  SimplifiedGroup result;
  result.merged_into = final_targets(record.collapses, mesh.vertex_count());
  for (const Collapse* const collapse : record.collapses) {
    result.error = std::max(result.error, collapse->error);
    result.guaranteed_error = std::max(result.guaranteed_error, collapse->guaranteed_error);
  }
  for (const float rank : record.ranks) result.cost = std::max(result.cost, rank);
  if (target.keeps_collapses) result.collapses = saturated(record.collapses, mesh.vertex_count());
  for (const LevelFace& face : state.mesh.faces()) result.triangles.push_back(face.corners);
  return result;
}

}  // namespace occlod
