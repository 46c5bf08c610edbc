// The knobs of refinement as a table: what bench_report sweeps, and how each value is asked for on the command line.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "occlod/refiner.h"

namespace occlod::bench {

// One way to refine.
struct Setting {
  std::string name;    // unique
  std::string series;  // settings of a series differ in nothing but their budget; empty when one knob was turned
  std::string knob;    // that one
  std::string flags;   // of `occlod render`; in brackets what it does not offer
  RefineOptions refine;
  bool occlusion = true;        // by the software backend
  bool frame_to_frame = false;  // Refiner::update() instead of refine()
  int raster_divisor = 1;       // one sample of its occluder for so many pixels in each direction
  bool attributes = true;       // see SceneObject

  // Others are measured to see what they would be worth, and never recommended.
  [[nodiscard]] bool is_offered() const { return raster_divisor == 1 && attributes; }
};

// What one value of a knob does to a setting.
struct Change {
  std::string name;
  std::string flags;
  std::function<void(Setting&)> apply;
};

struct Knob {
  std::string name;
  std::string about;
  std::vector<Change> values;  // beside the default
};

// Swept over all budgets, a series each.
[[nodiscard]] const std::vector<Change>& series();
// Turned one at a time at one budget.
[[nodiscard]] const std::vector<Knob>& knobs();

// Every series at every budget, then every value of every knob at `knob_budget`: the default first, what differs from
// it later.
[[nodiscard]] std::vector<Setting> all_settings(const std::vector<std::size_t>& budgets, std::size_t knob_budget);

}  // namespace occlod::bench
