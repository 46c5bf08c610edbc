// Builds the hierarchy of a mesh by half-edge collapses in the order of their quadric error (Garland & Heckbert 1997).
#pragma once

#include <cstddef>
#include <functional>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// How SplitNode::guaranteed_error comes about. Both are bounds; docs/benchmarks/guaranteed_error.md compares them.
enum class ErrorBound {
  accumulated,  // the movements of all collapses that led to a face, added up: several times too large on coarse meshes
  measured      // against the input mesh: tight, at several times the building time
};

struct BuildOptions {
  std::size_t base_triangles = 64;  // stop when the mesh has no more triangles than this; the base may have fewer
  double boundary_weight = 1.0;     // weight of the planes that hold boundary and non-manifold edges in place, relative
                                    // to the triangles beside them
  ErrorBound error_bound = ErrorBound::accumulated;
  int threads = 0;  // 0 = one for each core; the result does not depend on it
  // Called now and then with the share done, in [0, 1]; returning false cancels the build, which then throws Error.
  std::function<bool(double)> progress;
};

// Any triangle soup that clean() passes builds; the same mesh and options give the same bytes. Throws Error for a mesh
// without triangles, with an index out of range or a position that is not finite or has a coordinate beyond
// farthest_coordinate, and when cancelled.
// O(n log n) time; about 270 bytes a vertex beside the result while building.
[[nodiscard]] Hierarchy build_hierarchy(const TriangleMesh& mesh, const BuildOptions& options = {});

}  // namespace occlod
