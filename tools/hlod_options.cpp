#include "hlod_options.h"

#include <CLI/CLI.hpp>

#include "option_values.h"
#include "raster/device_cost_fields.h"

namespace occlod::tool {

void add_within(CLI::App& command, bool& geomorph, bool& within, const std::string& about_splits) {
  command
      .add_option_function<std::string>(
          "--within",
          [&geomorph, &within](const std::string& way) {
            geomorph = way == "geomorph";
            within = way == "splits";
          },
          "Between two levels: geomorph: let vertices slide to where the parent has them; " + about_splits)
      ->transform(one_of({"none", "geomorph", "splits"}))
      ->option_text("none|geomorph|splits [none]");
}

void add_traverse_options(CLI::App& command, hlod::TraverseOptions& options) {
  add_number(command, "--tolerance", options.tolerance_px, RealRange{},
             "Largest error on the screen that may stay, in pixels; 0: draw the input itself")
      ->capture_default_str();
  add_within(command, options.geomorph, options.within,
             "splits, of HLODs that have them (hlod build --within splits): refine nodes within instead of by their "
             "children where that is enough");
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
