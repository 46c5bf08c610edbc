// What the devices of bench_hlod_compare cost, for the strategies that need to know.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "command_files.h"
#include "occlod/device_costs.h"
#include "papers/trial_command.h"
#include "papers/trial_traverser.h"

namespace CLI {
class App;
}

namespace occlod::tool {

struct HlodCostOptions {
  std::string calibration;
  std::string save_calibration;
};

// --calibration, --save-calibration.
void add_hlod_cost_options(CLI::App& command, HlodCostOptions& options);
void add_files(CommandFiles& files, const HlodCostOptions& options);

// Of the devices, in their order: from the calibration file if one is named, by definition of simulated devices, else
// measured where one of the strategies needs them or they are to be saved; otherwise nothing. Saves what was asked for.
// Throws Error.
[[nodiscard]] std::vector<hlod::DeviceCosts> costs_of(const std::vector<TrialDevice>& devices,
                                                      const HlodCostOptions& options,
                                                      const std::vector<hlod::TrialStrategy>& strategies);

}  // namespace occlod::tool
