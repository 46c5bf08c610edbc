// Counts the different names in a text.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

namespace occlod {

// The names' characters outlive it. Takes 16 bytes for each line that names another than the line before.
class DistinctNames {
 public:
  // Empty names are none.
  void add(std::string_view name) {
    if (!name.empty() && (names_.empty() || names_.back() != name)) names_.push_back(name);
  }
  [[nodiscard]] std::size_t count() {
    std::ranges::sort(names_);
    const auto repeated = std::ranges::unique(names_);
    names_.erase(repeated.begin(), repeated.end());
    return names_.size();
  }

 private:
  std::vector<std::string_view> names_;
};

}  // namespace occlod
