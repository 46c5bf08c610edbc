// Bounds and normal cones of split subtrees.
#pragma once

#include "splits/assemble.h"
#include "splits/hierarchy_data.h"

namespace occlod {

// Makes the nodes: with them the hierarchy is complete. O(n * depth / 64 + n * 128) worst case; close to O(n) on meshes
// as they are. The result does not depend on the number of threads.
[[nodiscard]] HierarchyData bound_subtrees(Assembly assembly, unsigned threads);

}  // namespace occlod
