#include "simplify_group.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <numeric>

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
  for (const LevelFace& face : state.mesh.faces()) result.triangles.push_back(face.corners);
  return result;
}

}  // namespace occlod
