// One collapse sequence from the records of all blocks.
#pragma once

#include <vector>

#include "build_progress.h"
#include "collapse_worker.h"
#include "simplify.h"

namespace occlod {

// Records are in an order in which their collapses can be made. The sequence is in the order of ranks, which is another
// such order; ids become places in the sequence. `records` is taken apart.
[[nodiscard]] CollapseSequence join_records(std::vector<BlockRecord>& records, std::vector<LevelFace> base,
                                            unsigned threads, const ProgressPart& progress);

}  // namespace occlod
