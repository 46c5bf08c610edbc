#include "hlod_options.h"

#include <CLI/CLI.hpp>

#include "option_values.h"
#include "raster/device_cost_fields.h"

namespace occlod::tool {

void add_traverse_options(CLI::App& command, hlod::TraverseOptions& options) {
  add_number(command, "--tolerance", options.tolerance_px, RealRange{},
             "Largest error on the screen that may stay, in pixels; 0: draw the input itself")
      ->capture_default_str();
  command
      .add_option_function<std::string>(
          "--within",
          [&options](const std::string& way) {
            options.geomorph = way == "geomorph";
            options.within = way == "splits";
          },
          "Between two levels: geomorph: let vertices slide to where the parent has "
          "them; splits, of HLODs that have them (hlod build --within splits): refine "
          "nodes within instead of by their children where that is enough")
      ->transform(one_of({"none", "geomorph", "splits"}))
      ->option_text("none|geomorph|splits [none]");
}

Json to_json(const hlod::TraverseOptions& options) {
  return {{"tolerance_px", options.tolerance_px},
          {"bias", {{"s", options.bias.s}, {"t", options.bias.t}}},
          {"geomorph", options.geomorph},
          {"within", options.within}};
}

Json to_json(const hlod::DeviceCosts& costs) {
  Json json = {{"latency_commands", costs.latency_commands}};
  hlod::for_each_device_cost(costs, [&](const char* key, double value) { json[key] = value; });
  return json;
}

}  // namespace occlod::tool
