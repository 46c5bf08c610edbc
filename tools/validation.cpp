#include "validation.h"

#include <fmt/format.h>

#include "json_output.h"
#include "occlod/base.h"
#include "standard_streams.h"

namespace occlod::tool {

void report(const Validation& validation, bool json) {
  const auto& [file, violations, left_out, source] = validation;
  if (json)
    print_json(
        {{"file", file}, {"valid", violations.empty()}, {"violations", violations}, {"left_out", to_json(left_out)}});
  else if (violations.empty())
    fmt::print("{}: valid (left out of its {}: {})\n", printable(file), source, printable(in_words(left_out)));
  else
    for (const std::string& violation : violations) fmt::print("{}: {}\n", printable(file), printable(violation));
  if (!violations.empty()) throw Error({file, "", fmt::format("{} violations", violations.size()), "build it again"});
}

}  // namespace occlod::tool
