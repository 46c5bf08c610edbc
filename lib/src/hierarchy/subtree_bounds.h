// Bounds and normal cones of split subtrees.
#pragma once

#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

// Fills SplitNode::sphere and ::bounds. Everything else of `data` is complete.
// O(n * depth / 64 + n * 128) worst case; close to O(n) on meshes as they are.
void bound_subtrees(HierarchyData& data, unsigned threads);

}  // namespace occlod
