// Counts the different names in a text.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_set>

namespace occlod {

class DistinctNames {
 public:
  // Empty names are none.
  void add(std::string_view name) {
    if (!name.empty() && !names_.contains(name)) names_.emplace(name);
  }
  [[nodiscard]] std::size_t count() const { return names_.size(); }

 private:
  struct Hash : std::hash<std::string_view> {
    using is_transparent = void;
  };
  std::unordered_set<std::string, Hash, std::equal_to<>> names_;
};

}  // namespace occlod
