// Builds the hierarchy of a mesh by half-edge collapses in the order of their quadric error (Garland & Heckbert 1997).
#pragma once

#include <cstddef>
#include <functional>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// How SplitNode::guaranteed_error is computed. Both are upper bounds.
enum class ErrorBound {
  accumulated,  // the movements of all collapses that led to a face, added up: several times too large on coarse meshes
  measured      // against the input mesh: tight, at several times the building time
};

// How a hierarchy is built.
struct BuildOptions {
  std::size_t base_triangles = 64;  // stop at a base mesh of no more triangles than this; it may have fewer
  double boundary_weight = 1.0;     // weight of the planes that hold boundary and non-manifold edges in place, relative
                                    // to the triangles beside them; in [0, 1e6]
  double attribute_weight = 0.7;    // weight of how far texture coordinates, normals and colours slip, relative to
                                    // distances, where a mesh has texture coordinates or seams; in [0, 1e6]
  ErrorBound error_bound = ErrorBound::accumulated;  // how bounds on the distance to the input are computed
  int threads = 0;  // in [0, 1024]; 0: one for each core. The result does not depend on it
  // Called now and then on the calling thread with the share done, in [0, 1]; returning false cancels the build, which
  // then throws Error. What it throws ends the build too.
  std::function<bool(double)> progress = {};
};

// Any triangle soup that clean() accepts can be built; the same mesh and options give the same bytes, whatever the
// number of threads. Throws Error for an
// option out of its range, for a mesh without triangles, with an index out of range or a position that is not finite or
// has a coordinate beyond farthest_coordinate, and when cancelled.
// O(n log n) time; about 270 bytes a vertex beside the result while building.
[[nodiscard]] Hierarchy build_hierarchy(const TriangleMesh& mesh, const BuildOptions& options = {});

}  // namespace occlod
