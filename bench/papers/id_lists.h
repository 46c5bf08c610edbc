// Lists of ids: what changes from a cell to its neighbour, and its runs (Chhugani and others 2003, sec. 2.3 and 2.4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace occlod::paper {

using Ids = std::vector<std::uint32_t>;  // ascending, each once

// What one has to know to go from one cell to another, in either direction.
struct Delta {
  Ids added;
  Ids removed;
  friend bool operator==(const Delta&, const Delta&) = default;
};
// O(ids).
[[nodiscard]] Delta delta(std::span<const std::uint32_t> from, std::span<const std::uint32_t> to);
// `to` of delta(from, to). O(ids).
[[nodiscard]] Ids with_delta(const Delta& delta, std::span<const std::uint32_t> from);

// Runs of consecutive ids as numbers >= 1: from the end of the last run (before 0 at first) to the next, its length,
// and so on. O(ids).
[[nodiscard]] std::vector<std::uint32_t> runs_of(std::span<const std::uint32_t> ids);
// Back again.
[[nodiscard]] Ids ids_of_runs(std::span<const std::uint32_t> runs);
// From each id to the next, the first from before 0: numbers >= 1.
[[nodiscard]] std::vector<std::uint32_t> gaps_of(std::span<const std::uint32_t> ids);

}  // namespace occlod::paper
