#include <meshoptimizer.h>

#include <limits>

#include "peers/peers.h"
#include "stopwatch.h"

namespace occlod::bench {
namespace {

SimplifyRun simplify(const TriangleMesh& mesh, const std::vector<unsigned>& indices, std::size_t target) {
  std::vector<unsigned> left(indices.size());
  SimplifyRun run;
  const tool::Stopwatch stopwatch;
  left.resize(meshopt_simplify(left.data(), indices.data(), indices.size(), &mesh.positions[0].x, mesh.vertex_count(),
                               sizeof(glm::vec3), 3 * target, std::numeric_limits<float>::max()));
  run.milliseconds = stopwatch.milliseconds();
  run.result.positions = mesh.positions;
  for (std::size_t i = 0; i < left.size(); i += 3) run.result.triangles.emplace_back(left[i], left[i + 1], left[i + 2]);
  return run;
}

}  // namespace

std::vector<SimplifyRun> simplify_by_meshoptimizer(const TriangleMesh& mesh, std::span<const std::size_t> targets) {
  std::vector<unsigned> indices;
  indices.reserve(3 * mesh.triangle_count());
  for (const Triangle& t : mesh.triangles) indices.insert(indices.end(), {t.x, t.y, t.z});
  std::vector<SimplifyRun> runs;
  for (const std::size_t target : targets) runs.push_back(simplify(mesh, indices, target));
  return runs;
}

}  // namespace occlod::bench
