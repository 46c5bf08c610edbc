// From a collapse sequence to the arrays of a hierarchy.
#pragma once

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/mesh/triangle_mesh.h"
#include "simplify.h"

namespace occlod {

// Everything but the bounds (see subtree_bounds.h). O(n).
[[nodiscard]] HierarchyData assemble(const TriangleMesh& mesh, CollapseSequence sequence, unsigned threads);

}  // namespace occlod
