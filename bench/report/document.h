// What bench_report writes: all of it as JSON, the points as a table.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "json_output.h"
#include "report/settings.h"
#include "report/sweep.h"
#include "visibility/table.h"

namespace occlod::bench {

// The places of settings, of those that are offered.
struct Choice {
  std::size_t recommended = 0;
  std::size_t fastest = 0;                         // of the front of all
  std::size_t most_accurate = 0;                   // likewise
  std::size_t as_accurate = 0;                     // the fastest as accurate as the recommended, whatever its budget
  std::vector<std::optional<std::size_t>> within;  // the fastest within each of `error_limits_px`
  std::vector<std::size_t> budget_front;           // by time and error, of budgets no larger than the knobs'
};

inline constexpr double near_best = 1.1;    // times the least error
inline constexpr double time_noise = 1.25;  // times the least time
inline constexpr std::array error_limits_px = {4.0, 2.0, 1.0, 0.5, 0.25};

// By time and `main_measure`. Recommended is one of the settings with no more triangles than `budget` whose error is
// within near_best of the least of them: of those that take no more than time_noise of the fastest's time the first, so
// that a knob is turned only for what noise cannot be.
[[nodiscard]] Choice choose(const std::vector<Setting>& settings, const std::vector<Outcome>& over_all,
                            std::size_t budget);

// A row for each scene and setting; the scene "all" is all of them.
[[nodiscard]] Table points_table(const std::vector<Setting>& settings, const std::vector<SceneOutcomes>& scenes,
                                 const std::vector<Outcome>& over_all);

// measures, knobs, settings, scenes, fronts, choice, hash.
[[nodiscard]] tool::Json to_json(const std::vector<Setting>& settings, const std::vector<SceneOutcomes>& scenes,
                                 const std::vector<Outcome>& over_all, const Choice& choice,
                                 const SweepOptions& options);

}  // namespace occlod::bench
