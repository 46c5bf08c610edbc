// Offers check_structure() in parts, for files that are checked while they are used.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "occlod/hierarchy.h"

namespace occlod {

// Returns the number of positions without those of extra wedges.
[[nodiscard]] inline std::size_t vertex_count(const HierarchyView& data) noexcept {
  return data.positions.size() - data.extra_wedges.size();
}

// Holds the extra wedges of vertices first to first + count - 1. O(log extra wedges).
struct WedgeRange {
  WedgeId first = 0;
  std::uint32_t count = 0;
};
[[nodiscard]] WedgeRange extra_wedges_of(const HierarchyView& data, std::size_t first, std::size_t count = 1) noexcept;

// Check sizes, base mesh and roots; then splits [first, end), each on its own. Errors that only all splits together
// reveal are left to refinement, which descends to a child only if the child names its parent. Both return a
// description of the problem, or nothing.
[[nodiscard]] std::optional<std::string> check_base(const HierarchyView& data);
[[nodiscard]] std::optional<std::string> check_splits(const HierarchyView& data, SplitId first, SplitId end);

}  // namespace occlod
