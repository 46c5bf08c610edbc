#include "occlod/build_hierarchy.h"
#include "peers/peers.h"
#include "stopwatch.h"

namespace occlod::bench {
namespace {

std::vector<SimplifyRun> simplify(const TriangleMesh& mesh, std::span<const std::size_t> targets, int threads) {
  BuildOptions options;
  options.threads = threads;
  const tool::Stopwatch stopwatch;
  const Hierarchy hierarchy = build_hierarchy(mesh, options);
  const double milliseconds = stopwatch.milliseconds();
  std::vector<SimplifyRun> runs;
  for (const std::size_t target : targets)
    runs.push_back({milliseconds, cut_mesh(hierarchy, cut_to_triangles(hierarchy, target))});
  return runs;
}

}  // namespace

std::vector<SimplifyRun> simplify_by_occlod(const TriangleMesh& mesh, std::span<const std::size_t> targets) {
  return simplify(mesh, targets, 1);
}

std::vector<SimplifyRun> simplify_by_occlod_threads(const TriangleMesh& mesh, std::span<const std::size_t> targets) {
  return simplify(mesh, targets, 0);
}

}  // namespace occlod::bench
