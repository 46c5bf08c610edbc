// Turns a collapse sequence round into splits from coarse to fine.
#pragma once

#include "occlod/hierarchy/hierarchy.h"
#include "simplify.h"

namespace occlod {

// Everything but the bounds and cones: vertices and faces renumbered in refinement order, dependencies, split forest,
// saturated errors.
[[nodiscard]] HierarchyData assemble(const TriangleMesh& mesh, const CollapseSequence& sequence);

}  // namespace occlod
