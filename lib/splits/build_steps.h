// Checks the meshes that builders accept.
#pragma once

#include <cstdint>

#include "base/memory.h"
#include "occlod/mesh.h"
#include "splits/hierarchy_data.h"
#include "splits/simplify.h"
#include "splits/star_patch.h"

namespace occlod {

// Throws Error for a mesh without triangles, with an index out of range or a repeated corner, or with a position that
// is not finite or has a coordinate beyond farthest_coordinate. O(n).
void check_input(const TriangleMesh& mesh);

// Throws Error when two vertices have the same position; +0 and -0 are one. Expected O(n).
void check_welded(const TriangleMesh& mesh);

// Sets guaranteed_error of all collapses of `sequence`, which simplify() made of `mesh`. The two-sided distance of any
// cut from the input is at most the largest guaranteed error of the collapses that it has made. Errors larger than the
// input's triangles are measured against the input; smaller ones stay accumulated, as simplify() left them. The mesh is
// scaled during the call. docs/internals/error_metric.md has the proofs. O(n log n).
void measure_errors(TriangleMesh& mesh, CollapseSequence& sequence);

// Converts a collapse sequence to the arrays of a hierarchy.

// Holds a hierarchy without its nodes, and the per-split data from which the nodes are made.
struct Assembly {
  struct Errors {
    float quadric = 0.0F, guaranteed = 0.0F;  // saturated
  };
  HierarchyData data;
  UninitializedVector<std::uint32_t> stars;  // start of each record; one more entry marks the end of the last
  UninitializedVector<SplitId> parents, children_u, children_v;
  UninitializedVector<Errors> errors;
  UninitializedVector<BoundedPatch> patches;
};

// Assembles the arrays. `mesh` is the input of the sequence. O(n).
[[nodiscard]] Assembly assemble(const TriangleMesh& mesh, CollapseSequence sequence, unsigned threads);

// Makes the nodes with the bounds and normal cones of split subtrees, which completes the hierarchy. O(n * depth / 64 +
// n * 8,192) in the worst case; close to O(n) on real meshes. The result does not depend on the number of threads.
[[nodiscard]] HierarchyData bound_subtrees(Assembly assembly, unsigned threads);

}  // namespace occlod
