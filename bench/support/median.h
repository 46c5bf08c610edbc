#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace occlod::bench {

// The middle of the values (the upper one of two); at least one.
[[nodiscard]] inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace occlod::bench
