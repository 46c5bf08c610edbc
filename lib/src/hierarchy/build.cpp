#include "occlod/hierarchy/build.h"

#include <cmath>

#include "assemble.h"
#include "core/large_vector.h"
#include "core/option_checker.h"
#include "hierarchy_data.h"
#include "math/inverse_power_of_two.h"
#include "measure_error.h"
#include "occlod/core/error.h"
#include "parallel.h"
#include "simplify.h"
#include "spatial_order.h"
#include "subtree_bounds.h"

namespace occlod {
namespace {

void check_options(const BuildOptions& options) {
  const OptionChecker check("build");
  check.in_range("boundary_weight", options.boundary_weight, 0.0, 1e6);
  check.in_range("threads", options.threads, 0, 1024);
}

void check_input(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw Error({"mesh", "", "has no triangles", "give a mesh with at least one"});
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::vec3& p = mesh.positions[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw Error({"mesh", "vertex " + std::to_string(v), "is not finite", "run clean() on the mesh first"});
    if (largest_coordinate(p) > farthest_coordinate)
      throw Error(
          {"mesh", "vertex " + std::to_string(v), "is farther than 1.5e37 from the origin", "scale the mesh down"});
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    const std::size_t n = mesh.vertex_count();
    if (corners.x >= n || corners.y >= n || corners.z >= n || corners.x == corners.y || corners.y == corners.z ||
        corners.z == corners.x)
      throw Error({"mesh", "triangle " + std::to_string(t), "repeats a corner or refers to a vertex that is not there",
                   "run clean() on the mesh first"});
  }
}

}  // namespace

Hierarchy build_hierarchy(const TriangleMesh& mesh, const BuildOptions& options) {
  check_options(options);
  check_input(mesh);
  const unsigned threads = thread_count(options.threads);
  const LargeMemoryReuse reuse;
  TriangleMesh ordered = in_spatial_order(mesh, threads);
  CollapseSequence sequence = simplify(ordered, options);
  if (options.error_bound == ErrorBound::measured) measure_errors(ordered, sequence);
  return make_hierarchy(bound_subtrees(assemble(ordered, std::move(sequence), threads), threads));
}

}  // namespace occlod
