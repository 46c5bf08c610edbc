// From drafts of all levels to the arrays of an HLOD.
#pragma once

#include <vector>

#include "hlod/build/level_draft.h"
#include "hlod/store/hlod_data.h"
#include "occlod/build_hlod.h"

namespace occlod::hlod {

// Numbers nodes from coarse to fine, sorts the triangles of each into patches, and gives each node vertices of its own.
// `levels` from level 0; they are used up. Fills all fields but grouping, borders and node_triangles. The result does
// not depend on the threads. O(n log n) within each node.
[[nodiscard]] HlodData assemble(const WedgeMesh& mesh, std::vector<LevelDraft> levels, Within within, unsigned threads);

}  // namespace occlod::hlod
