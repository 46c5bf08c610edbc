// Refinement by splits beside HLODs of the same scene.
#pragma once

#include <string>
#include <vector>

#include "beside_hlod.h"
#include "report/sweep.h"

namespace occlod::bench {

// What `auto` takes frame to frame for the knobs' budget, and what HLODs take that leave no larger error, along the
// bursts of a path. Throws Error as load_hlods() does.
[[nodiscard]] std::vector<tool::WayCost> compare_with_hlods(const SceneRun& run, const std::string& path,
                                                            const SweepOptions& options);

}  // namespace occlod::bench
