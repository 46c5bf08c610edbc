#include "occlod/build_hierarchy.h"
#include "stopwatch.h"
#include "wedges/simplifiers.h"
#include "wedges/subjects.h"

namespace occlod::bench {
namespace {

std::vector<WedgeRun> simplify(const TriangleMesh& mesh, std::span<const std::size_t> targets) {
  BuildOptions options;
  options.threads = 1;
  const tool::Stopwatch stopwatch;
  const Hierarchy hierarchy = build_hierarchy(mesh, options);
  const double milliseconds = stopwatch.milliseconds();
  const double bytes = static_cast<double>(hierarchy.bytes()) / static_cast<double>(hierarchy.vertex_count());
  std::vector<WedgeRun> runs;
  for (const std::size_t target : targets)
    runs.push_back({cut_mesh(hierarchy, cut_to_triangles(hierarchy, target)), milliseconds, bytes});
  return runs;
}

}  // namespace

std::vector<WedgeSimplifier> occlod_simplifiers() {
  const auto geometry = [](const TriangleMesh& mesh, std::span<const std::size_t> targets) {
    return simplify(geometry_of(mesh), targets);
  };
  return {{"occlod", "", simplify}, {"occlod", "geometry", geometry}};
}

}  // namespace occlod::bench
