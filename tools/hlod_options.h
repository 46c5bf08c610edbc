// Options that `occlod hlod render` and `hlod compare` share.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "json_output.h"
#include "occlod/traverser.h"

namespace CLI {
class App;
}

namespace occlod::tool {

// --tolerance, --bias, --metric, --alpha, --coherence, --cover-model, --geomorph, --within.
void add_traverse_options(CLI::App& command, hlod::TraverseOptions& options);
// All but the strategy.
[[nodiscard]] Json to_json(const hlod::TraverseOptions& options);

}  // namespace occlod::tool
