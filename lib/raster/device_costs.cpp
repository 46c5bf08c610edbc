#include "occlod/device_costs.h"

#include "base/option_checker.h"
#include "raster/device_cost_fields.h"

namespace occlod::hlod {

void check_device_costs(const char* subject, const DeviceCosts& costs) {
  const OptionChecker checker(subject);
  for_each_device_cost(costs, [&](const char* key, double value) { checker.at_least(key, value, 0.0); });
}

}  // namespace occlod::hlod
