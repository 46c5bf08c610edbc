// Names strategies of HLOD traversal on the command line and in the viewer.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "occlod/traverser.h"

namespace occlod::tool {

// Returns them in the order in which help lists them.
[[nodiscard]] const std::vector<std::pair<std::string, hlod::Strategy>>& strategies();
[[nodiscard]] const std::string& name_of(hlod::Strategy strategy);

}  // namespace occlod::tool
