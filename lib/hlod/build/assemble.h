// Turns the drafts of all levels into the arrays of an HLOD.
#pragma once

#include <vector>

#include "hlod/build/level_draft.h"
#include "hlod/store/hlod_data.h"
#include "occlod/build_hlod.h"

namespace occlod::hlod {

// Numbers nodes from coarse to fine, sorts the triangles of each into patches, and gives each node vertices of its own.
// `levels` starts at level 0 and is used up. Fills all fields but grouping, borders and node_triangles. The result does
// not depend on the number of threads. O(n log n) within each node.
[[nodiscard]] HlodData assemble(const WedgeMesh& mesh, std::vector<LevelDraft> levels, Within within, unsigned threads);

}  // namespace occlod::hlod
