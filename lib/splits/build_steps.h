// What builders ask of a mesh.
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

// Guaranteed errors that are measured instead of added up. docs/guide/error_metric.md has the proofs.

// Sets guaranteed_error of all collapses of `sequence`, which simplify() made of `mesh`, so that no cut is farther from
// the input, both ways, than the largest of the collapses that it has made: measured against the input where errors are
// larger than its triangles; below that they stay added up, as simplify() left them. The mesh is scaled for the time of
// the call. O(n log n).
void measure_errors(TriangleMesh& mesh, CollapseSequence& sequence);

// From a collapse sequence to the arrays of a hierarchy.

// A hierarchy but for its nodes, and what goes into them, split by split.
struct Assembly {
  struct Errors {
    float quadric = 0.0F, guaranteed = 0.0F;  // saturated
  };
  HierarchyData data;
  UninitializedVector<std::uint32_t> stars;  // where records start; one more, where the last ends
  UninitializedVector<SplitId> parents, children_u, children_v;
  UninitializedVector<Errors> errors;
  UninitializedVector<BoundedPatch> patches;
};

// `mesh` is what the sequence was made from. O(n).
[[nodiscard]] Assembly assemble(const TriangleMesh& mesh, CollapseSequence sequence, unsigned threads);

// Bounds and normal cones of split subtrees.

// Makes the nodes: with them the hierarchy is complete. O(n * depth / 64 + n * 128) worst case; close to O(n) on meshes
// as they are. The result does not depend on the number of threads.
[[nodiscard]] HierarchyData bound_subtrees(Assembly assembly, unsigned threads);

}  // namespace occlod
