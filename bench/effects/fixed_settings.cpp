#include "effects/fixed_settings.h"

#include <fmt/format.h>

#include <cstdint>

#include "refine/tuning.h"

namespace occlod::bench {
namespace {

struct Steps {
  const char* name;
  std::vector<std::uint32_t> splits;
};

std::vector<Steps> occluder_steps(std::size_t budget) {
  const auto of_budget = [&](std::size_t divisor) { return static_cast<std::uint32_t>(budget / divisor); };
  return {{"adaptive", {}},
          {"64", {64}},
          {"N/32", {of_budget(32)}},
          {"N/8", {of_budget(8)}},
          {"N/32,N/4", {of_budget(32), of_budget(4)}}};
}

}  // namespace

std::vector<FixedSetting> fixed_settings(std::size_t budget) {
  std::vector<FixedSetting> settings;
  RefineOptions options;
  options.budget = budget;
  settings.push_back({"none", options, false});
  RefineOptions without_cones = options;
  without_cones.effects = {{.cones = false}};
  settings.push_back({"none, no cones", without_cones, false});
  for (const Steps& steps : occluder_steps(budget))
    for (const std::uint32_t levels : {1U, 2U, 4U})
      for (const bool stars : {false, true})
        for (const bool retest : {false, true})
          for (const bool check : {false, true}) {
            tune(options).occluder_splits = steps.splits;
            tune(options).level_step = levels;
            tune(options).ask_stars = stars;
            tune(options).retest_hidden = retest;
            tune(options).final_check = check;
            settings.push_back({fmt::format("steps {}, levels {}{}{}{}", steps.name, levels, stars ? ", stars" : "",
                                            retest ? ", retest" : "", check ? ", final check" : ""),
                                options});
          }
  return settings;
}

}  // namespace occlod::bench
