// check_structure() in parts, for files that are checked as they are used.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "occlod/hierarchy.h"

namespace occlod {

// Positions without those of extra wedges.
[[nodiscard]] inline std::size_t vertex_count(const HierarchyView& data) noexcept {
  return data.positions.size() - data.extra_wedges.size();
}

// The extra wedges of vertices first to first + count - 1. O(log extra wedges).
struct WedgeRange {
  WedgeId first = 0;
  std::uint32_t count = 0;
};
[[nodiscard]] WedgeRange extra_wedges_of(const HierarchyView& data, std::size_t first, std::size_t count = 1) noexcept;

// Sizes, base mesh and roots; then splits [first, end), each on its own. What only all of them together show is left to
// refinement, which descends to a child only if the child names its parent. Return what is wrong, or nothing.
[[nodiscard]] std::optional<std::string> check_base(const HierarchyView& data);
[[nodiscard]] std::optional<std::string> check_splits(const HierarchyView& data, SplitId first, SplitId end);

}  // namespace occlod
