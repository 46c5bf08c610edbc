// What bench_wedges writes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "wedges/scores.h"

namespace occlod::bench {

// All rows, with a line of column names.
[[nodiscard]] std::string csv_of(std::span<const WedgeRow> rows);

// Reads what csv_of() writes. Throws Error.
[[nodiscard]] std::vector<WedgeRow> read_csv(const std::string& file);

// For each mesh and target, a row for each tool: of those with several settings, the one with the smallest slip among
// those whose geometric error is at most 1.25 times the least of them.
[[nodiscard]] std::string best_table(std::span<const WedgeRow> rows);

// Slips at equal numbers of triangles and equal geometric errors: for each of our rows the smallest slip that a tool
// has with as many triangles where its geometric RMS is ours, between two of its settings in logarithms, and ours
// divided by it. Where it is worse with every setting, the setting with the least is taken.
[[nodiscard]] std::string equal_error_table(std::span<const WedgeRow> rows);

// One number for all results.
[[nodiscard]] std::uint64_t hash_of(std::span<const WedgeRow> rows);

}  // namespace occlod::bench
