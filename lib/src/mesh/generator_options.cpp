#include "mesh/generator_options.h"

#include <fmt/format.h>

#include "occlod/core/error.h"

namespace occlod {

void OptionChecker::in_range(const char* option, double value, double low, double high) const {
  if (value >= low && value <= high) return;
  throw Error({generator_, fmt::format("option {}", option), fmt::format("{} is out of range", value),
               fmt::format("choose a value from {} to {}", low, high)});
}

}  // namespace occlod
