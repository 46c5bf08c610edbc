#include "papers/hlod_costs.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string_view>

#include "occlod/auto_refiner.h"
#include "occlod/device.h"
#include "occlod/visibility.h"
#include "option_values.h"

namespace occlod::tool {
namespace {

// What else the file holds stays, or is measured.
void save(const std::string& file, const std::vector<hlod::DeviceCosts>& costs) {
  Calibration calibration;
  if (std::filesystem::exists(file)) {
    calibration = read_calibration(file);
  } else {
    std::vector<std::unique_ptr<Visibility>> backends;
    backends.push_back(make_software_occlusion());
    calibration = measure_calibration(backends);
  }
  for (const hlod::DeviceCosts& device : costs) {
    const auto old = std::find_if(calibration.devices.begin(), calibration.devices.end(),
                                  [&](const hlod::DeviceCosts& known) { return known.name == device.name; });
    if (old == calibration.devices.end())
      calibration.devices.push_back(device);
    else
      *old = device;
  }
  write_calibration(file, calibration);
}

std::string_view without_prefix(std::string_view name, std::string_view prefix) {
  return name.starts_with(prefix) ? name.substr(prefix.size()) : name;
}

}  // namespace

void add_hlod_cost_options(CLI::App& command, HlodCostOptions& options) {
  add_file(command, "--calibration", options.calibration,
           "nohc, optimum, batch, auto: take what the device's commands cost from this file instead of measuring it "
           "(virtual: of taking its own), so that the same nodes are drawn again");
  add_file(command, "--save-calibration", options.save_calibration,
           "Write these costs into a calibration file, beside what it holds already");
}

void add_files(CommandFiles& files, const HlodCostOptions& options) {
  if (!options.calibration.empty()) files.add_input("the calibration to read", options.calibration);
  if (!options.save_calibration.empty()) files.add_output("--save-calibration", options.save_calibration);
}

std::vector<hlod::DeviceCosts> costs_of(const std::vector<TrialDevice>& devices, const HlodCostOptions& options,
                                        const std::vector<hlod::TrialStrategy>& strategies) {
  const bool needed = !options.save_calibration.empty() ||
                      std::ranges::any_of(strategies, [](hlod::TrialStrategy s) { return hlod::needs_costs(s); });
  std::vector<hlod::DeviceCosts> costs(devices.size());
  if (!options.calibration.empty()) {
    const Calibration calibration = read_calibration(options.calibration);
    for (std::size_t i = 0; i < devices.size(); ++i)
      costs[i] = device_costs_of(calibration, without_prefix(devices[i].name, "recorded:"));
  } else if (needed) {
    for (std::size_t i = 0; i < devices.size(); ++i) {
      costs[i] = devices[i].costs ? *devices[i].costs : hlod::measure_costs(*devices[i].device);
      costs[i].name = devices[i].name;
    }
  }
  if (!options.save_calibration.empty()) save(options.save_calibration, costs);
  return costs;
}

}  // namespace occlod::tool
