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
    // Not std::ranges::unique: clang 14 cannot read the subrange of GCC 12's library.
    names_.erase(std::unique(names_.begin(), names_.end()), names_.end());
    return names_.size();
  }

 private:
  std::vector<std::string_view> names_;
};

}  // namespace occlod
