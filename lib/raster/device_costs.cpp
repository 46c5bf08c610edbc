#include "occlod/device_costs.h"

#include <algorithm>
#include <array>

#include "base/file_input.h"
#include "base/option_checker.h"
#include "occlod/base.h"
#include "raster/device_cost_fields.h"

namespace occlod::hlod {
namespace {

// Grounds: docs/guide/hlod.md.
const std::array<DeviceCosts, 4>& presets() {
  static const std::array<DeviceCosts, 4> all{{
      {.name = "query-cheap",
       .draw_ns = 10'000.0,
       .triangle_ns = 8.0,
       .fragment_ns = 0.3,
       .query_ns = 3'000.0,
       .query_fragment_ns = 0.1,
       .wrapped_query_ns = 3'000.0,
       .readback_ns = 15'000.0,
       .batch_ns = 200'000.0,
       .batch_item_ns = 200.0,
       .submit_ns = 3'000.0,
       .visit_ns = 500.0},
      {.name = "query-dear",
       .draw_ns = 15'000.0,
       .triangle_ns = 14.0,
       .fragment_ns = 1.5,
       .query_ns = 12'000.0,
       .query_fragment_ns = 0.5,
       .wrapped_query_ns = 12'000.0,
       .readback_ns = 50'000.0,
       .batch_ns = 400'000.0,
       .batch_item_ns = 500.0,
       .submit_ns = 5'000.0,
       .visit_ns = 1'000.0},
      {.name = "fill-bound",
       .draw_ns = 10'000.0,
       .triangle_ns = 8.0,
       .fragment_ns = 4.0,
       .query_ns = 4'000.0,
       .query_fragment_ns = 0.4,
       .wrapped_query_ns = 4'000.0,
       .readback_ns = 15'000.0,
       .batch_ns = 300'000.0,
       .batch_item_ns = 200.0,
       .submit_ns = 3'000.0,
       .visit_ns = 500.0},
      {.name = "modern",
       .draw_ns = 1'000.0,
       .triangle_ns = 0.3,
       .fragment_ns = 0.05,
       .query_ns = 2'000.0,
       .query_fragment_ns = 0.01,
       .wrapped_query_ns = 2'000.0,
       .readback_ns = 20'000.0,
       .batch_ns = 40'000.0,
       .batch_item_ns = 10.0,
       .submit_ns = 500.0,
       .visit_ns = 50.0},
  }};
  return all;
}

}  // namespace

void check_device_costs(const char* subject, const DeviceCosts& costs) {
  const OptionChecker checker(subject);
  for_each_device_cost(costs, [&](const char* key, double value) { checker.at_least(key, value, 0.0); });
}

std::span<const DeviceCosts> device_presets() { return presets(); }

const DeviceCosts& device_preset(std::string_view name) {
  const auto found =
      std::find_if(presets().begin(), presets().end(), [&](const DeviceCosts& costs) { return costs.name == name; });
  if (found != presets().end()) return *found;
  std::string names;
  for (const DeviceCosts& costs : presets()) names += (names.empty() ? "" : ", ") + costs.name;
  throw Error({"virtual device", "preset " + in_quotes(name), "is none of " + names, "choose one of them"});
}

}  // namespace occlod::hlod
