// From a collapse sequence to the arrays of a hierarchy.
#pragma once

#include <cstdint>

#include "core/large_vector.h"
#include "hierarchy_data.h"
#include "occlod/mesh/triangle_mesh.h"
#include "simplify.h"

namespace occlod {

// A hierarchy but for its nodes, and what goes into them beside bounds, split by split.
struct Assembly {
  struct Errors {
    float quadric = 0.0F, guaranteed = 0.0F;  // saturated
  };
  HierarchyData data;
  LargeVector<std::uint32_t> stars;  // where records start; one more, where the last ends
  LargeVector<SplitId> parents, children_u, children_v;
  LargeVector<Errors> errors;
};

// `mesh` is what the sequence was made from. O(n).
[[nodiscard]] Assembly assemble(const TriangleMesh& mesh, CollapseSequence sequence, unsigned threads);

}  // namespace occlod
