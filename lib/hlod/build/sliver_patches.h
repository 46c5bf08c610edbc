// Spares patches that are too small to be worth a draw call.
#pragma once

#include <cstdint>

#include "hlod/build/group_triangles.h"
#include "hlod/build/level_draft.h"

namespace occlod::hlod {

// A patch is what a node has in one group. Those with less than a 32nd of `node_triangles` triangles move to the group
// of the same node that shares most vertices with them, unless that makes a group too large for 16-bit indices. Any
// assignment of triangles to groups is legal. The result does not depend on the threads. O(n log n) within each node.
void move_slivers(const LevelDraft& level, std::uint32_t node_triangles, TriangleGroups& groups, unsigned threads);

}  // namespace occlod::hlod
