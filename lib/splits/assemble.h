// From a collapse sequence to the arrays of a hierarchy.
#pragma once

#include <cstdint>

#include "base/large_vector.h"
#include "splits/hierarchy_data.h"
#include "occlod/mesh/triangle_mesh.h"
#include "splits/simplify.h"
#include "splits/star_patch.h"

namespace occlod {

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

}  // namespace occlod
