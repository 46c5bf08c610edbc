// Options of refinement that are not finite or out of their range, one field each.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/refiner.h"
#include "refine/tuning.h"

namespace occlod::test {

struct BadOptions {
  std::string field;  // that the error names
  std::function<void(RefineOptions&)> spoil;
};

[[nodiscard]] inline std::vector<BadOptions> bad_options() {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  std::vector<BadOptions> rows;
  const auto add = [&rows](const char* field, auto spoil) { rows.push_back({field, spoil}); };
  for (const double value : {nan, infinite, -1.0}) {
    add("tolerance_px", [value](RefineOptions& o) { o.tolerance_px = value; });
    add("tuning.visible_exponent", [value](RefineOptions& o) { tune(o).visible_exponent = value; });
    add("tuning.grazing_exponent", [value](RefineOptions& o) { tune(o).grazing_exponent = value; });
    add("tuning.forced_exponent", [value](RefineOptions& o) { tune(o).forced_exponent = value; });
    add("tuning.covered_factor", [value](RefineOptions& o) { tune(o).covered_factor = value; });
    add("tuning.hysteresis", [value](RefineOptions& o) { tune(o).hysteresis = value; });
    add("time_limit_ms", [value](RefineOptions& o) { o.time_limit_ms = value; });
  }
  add("tuning.visible_exponent", [](RefineOptions& o) { tune(o).visible_exponent = 8.001; });
  add("tuning.grazing_exponent", [](RefineOptions& o) { tune(o).grazing_exponent = 8.001; });
  add("tuning.forced_exponent", [](RefineOptions& o) { tune(o).forced_exponent = 8.001; });
  add("tuning.covered_factor", [](RefineOptions& o) { tune(o).covered_factor = 0.0; });
  add("tuning.covered_factor", [](RefineOptions& o) { tune(o).covered_factor = 1.001; });
  add("tuning.hysteresis", [](RefineOptions& o) { tune(o).hysteresis = 1.0; });
  add("tuning.hysteresis", [](RefineOptions& o) { tune(o).hysteresis = 2.0; });
  add("threads", [](RefineOptions& o) { o.threads = -1; });
  add("threads", [](RefineOptions& o) { o.threads = 1025; });
  add("tuning.level_step", [](RefineOptions& o) { tune(o).level_step = 0; });
  add("tuning.occluder_splits", [](RefineOptions& o) { tune(o).occluder_splits = {300, 200}; });
  add("tuning.occluder_splits", [](RefineOptions& o) { tune(o).occluder_splits = {100, 200, 200}; });
  return rows;
}

// What refinement says about each row: an Error whose place is the field.
inline void expect_all_refused(const std::function<void(const RefineOptions&)>& refine) {
  for (const BadOptions& row : bad_options()) {
    RefineOptions options;
    row.spoil(options);
    try {
      refine(options);
      ADD_FAILURE() << row.field << " is accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.diagnosis().place, "option " + row.field) << error.what();
    }
  }
}

}  // namespace occlod::test
