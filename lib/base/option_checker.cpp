#include "base/option_checker.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "occlod/base.h"

namespace occlod {
namespace {

[[noreturn]] void refuse(const char* subject, const char* option, double value, const std::string& range) {
  throw Error(
      {subject, fmt::format("option {}", option), fmt::format("{} is out of range", value), "choose a value " + range});
}

}  // namespace

void OptionChecker::in_range(const char* option, double value, double low, double high) const {
  if (!(value >= low && value <= high)) refuse(subject_, option, value, fmt::format("from {} to {}", low, high));
}

void OptionChecker::below(const char* option, double value, double low, double end) const {
  if (!(value >= low && value < end)) refuse(subject_, option, value, fmt::format("from {} to below {}", low, end));
}

void OptionChecker::at_least(const char* option, double value, double low) const {
  if (!(value >= low && std::isfinite(value))) refuse(subject_, option, value, fmt::format("of at least {}", low));
}

void OptionChecker::positive(const char* option, double value) const {
  if (!(value > 0.0 && std::isfinite(value))) refuse(subject_, option, value, "larger than 0");
}

}  // namespace occlod
