#include "occlod/hierarchy/build.h"

#include "splits/assemble.h"
#include "splits/check_input.h"
#include "base/large_vector.h"
#include "base/option_checker.h"
#include "splits/hierarchy_data.h"
#include "splits/measure_error.h"
#include "splits/parallel.h"
#include "splits/simplify.h"
#include "splits/spatial_order.h"
#include "splits/subtree_bounds.h"

namespace occlod {
namespace {

void check_options(const BuildOptions& options) {
  const OptionChecker check("build");
  check.in_range("boundary_weight", options.boundary_weight, 0.0, 1e6);
  check.in_range("attribute_weight", options.attribute_weight, 0.0, 1e6);
  check.in_range("threads", options.threads, 0, 1024);
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
