// check_structure() in parts, for files that are checked as they are used.
#pragma once

#include <optional>
#include <string>

#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

// Sizes, base mesh and roots; then splits [first, end), each on its own. What only all of them together show is left to
// refinement, which descends to a child only if the child names its parent. Return what is wrong, or nothing.
[[nodiscard]] std::optional<std::string> check_base(const HierarchyView& data);
[[nodiscard]] std::optional<std::string> check_splits(const HierarchyView& data, SplitId first, SplitId end);

}  // namespace occlod
