// Strategies of HLOD traversal by their names: those of the command line and of the viewer.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "occlod/traverser.h"

namespace occlod::tool {

// In the order in which help lists them.
[[nodiscard]] const std::vector<std::pair<std::string, hlod::Strategy>>& strategies();
[[nodiscard]] const std::string& name_of(hlod::Strategy strategy);

}  // namespace occlod::tool
