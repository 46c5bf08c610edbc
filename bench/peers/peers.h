// Simplifiers to compare with, each behind the same function.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::bench {

struct SimplifyRun {
  double milliseconds = 0.0;  // of simplifying alone, from the tool's own kind of mesh
  TriangleMesh result;
};

// One run for each target, a number of triangles that the result should have at most.
using Simplify = std::vector<SimplifyRun>(const TriangleMesh& mesh, std::span<const std::size_t> targets);

// One build of the whole hierarchy, down to the base mesh, serves all targets and takes the same time for each. On one
// thread, as the others are, and on one for each core.
[[nodiscard]] Simplify simplify_by_occlod;
[[nodiscard]] Simplify simplify_by_occlod_threads;
// meshopt_simplify without a limit on the error.
[[nodiscard]] Simplify simplify_by_meshoptimizer;
// DecimaterT with ModQuadricT: half-edge collapses. Triangles that a half-edge mesh cannot hold are left out.
[[nodiscard]] Simplify simplify_by_openmesh;

}  // namespace occlod::bench
