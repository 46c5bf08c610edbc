// One collapse sequence from the records of all blocks.
#pragma once

#include "splits/build_progress.h"
#include "splits/collapse_records.h"
#include "splits/simplify.h"

namespace occlod {

// Fills in the sequence's collapses, their places and the misplaced faces. Records are in an order in which their
// collapses can be made. The sequence is in the order of ranks, which is another such order. `records` is taken apart.
void join_records(CollapseRecords& records, CollapseSequence& sequence, unsigned threads, const ProgressPart& progress);

}  // namespace occlod
