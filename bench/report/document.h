// What bench_report writes: all of it as JSON, the points as a table.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "json_output.h"
#include "report/settings.h"
#include "report/sweep.h"
#include "visibility/table.h"

namespace occlod::bench {

// The places of settings.
struct Choice {
  std::size_t fastest = 0;
  std::size_t recommended = 0;
  std::size_t most_accurate = 0;
  std::vector<std::optional<std::size_t>> within;  // the fastest within each of `error_limits_px`
};

inline constexpr double recommended_error_px = 1.0;
inline constexpr double error_limits_px[] = {4.0, 2.0, 1.0, 0.5, 0.25};

// By time and `main_measure`. The fastest within recommended_error_px is recommended, the most accurate if there is
// none.
[[nodiscard]] Choice choose(const std::vector<Outcome>& over_all);

// A row for each scene and setting; the scene "all" is all of them.
[[nodiscard]] Table points_table(const std::vector<Setting>& settings, const std::vector<SceneOutcomes>& scenes,
                                 const std::vector<Outcome>& over_all);

// measures, knobs, settings, scenes, fronts, choice, hash.
[[nodiscard]] tool::Json to_json(const std::vector<Setting>& settings, const std::vector<SceneOutcomes>& scenes,
                                 const std::vector<Outcome>& over_all, const Choice& choice,
                                 const SweepOptions& options);

}  // namespace occlod::bench
