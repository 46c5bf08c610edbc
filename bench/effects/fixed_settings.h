// The settings that `auto` is compared with.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "occlod/refiner.h"

namespace occlod::bench {

struct FixedSetting {
  std::string name;
  RefineOptions options;
  bool occlusion = true;  // by the software backend
};

// Without occlusion, with cones and without; and every combination of occluder steps, levels, questions about stars,
// retests and the final check.
[[nodiscard]] std::vector<FixedSetting> fixed_settings(std::size_t budget);

}  // namespace occlod::bench
