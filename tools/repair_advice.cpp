#include "repair_advice.h"

#include <fmt/format.h>

#include <cstdint>
#include <utility>

namespace occlod::tool {

std::optional<std::string> repair_advice(const MeshReport& report) {
  const std::pair<std::uint64_t, const char*> faults[] = {{report.inconsistent_edges, "inconsistent edges"},
                                                          {report.repeated_triangles, "repeated triangles"},
                                                          {report.zero_area_triangles, "triangles without area"}};
  std::string found;
  for (const auto& [count, what] : faults) {
    if (count > 0) found += fmt::format("{}{} {}", found.empty() ? "" : ", ", count, what);
  }
  if (found.empty()) return std::nullopt;
  return "occlod repair may fix " + found;
}

}  // namespace occlod::tool
