#include <fmt/format.h>

#include <cstddef>

#include "base/option_checker.h"
#include "occlod/core/error.h"
#include "occlod/refine/refine_options.h"

namespace occlod {
namespace {

constexpr double largest_exponent = 8.0;  // weights beyond leave the range of floats

void check_ascending(const std::vector<std::uint32_t>& splits) {
  for (std::size_t i = 1; i < splits.size(); ++i)
    if (splits[i] <= splits[i - 1])
      throw Error({"refinement", "option occluder.splits", fmt::format("{} follows {}", splits[i], splits[i - 1]),
                   "give ascending numbers"});
}

}  // namespace

void check_options(const RefineOptions& options) {
  const OptionChecker check("refinement");
  check.at_least("tolerance_px", options.tolerance_px, 0.0);
  check.in_range("priority.visible_exponent", options.priority.visible_exponent, 0.0, largest_exponent);
  check.in_range("priority.grazing_exponent", options.priority.grazing_exponent, 0.0, largest_exponent);
  check.in_range("priority.forced_exponent", options.priority.forced_exponent, 0.0, largest_exponent);
  check_ascending(options.occluder.splits);
  check.at_least("queries.level_step", options.queries.level_step, 1.0);
  check.below("update.hysteresis", options.update.hysteresis, 0.0, 1.0);
  check.at_least("update.time_limit_ms", options.update.time_limit_ms, 0.0);
  check.in_range("threads", options.threads, 0, 1024);
}

}  // namespace occlod
