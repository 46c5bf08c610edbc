// Adds the options of `occlod hlod render` that decide what is drawn.
#pragma once

#include <string>

#include "json_output.h"
#include "occlod/device_costs.h"
#include "occlod/traverser.h"

namespace CLI {
class App;
}

namespace occlod::tool {

// Adds --within none|geomorph|splits.
void add_within(CLI::App& command, bool& geomorph, bool& within, const std::string& about_splits);
// Adds --tolerance and --within.
void add_traverse_options(CLI::App& command, hlod::TraverseOptions& options);
// Omits the strategy and the costs.
[[nodiscard]] Json to_json(const hlod::TraverseOptions& options);
[[nodiscard]] Json to_json(const hlod::DeviceCosts& costs);

}  // namespace occlod::tool
