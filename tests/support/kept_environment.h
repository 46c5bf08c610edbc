// Environment variables that a test changes, and that the tests after it in the same process find as they were.
#pragma once

#include <cstdlib>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace occlod::test {

class KeptEnvironment {
 public:
  KeptEnvironment(std::initializer_list<const char*> names) {
    for (const char* name : names) {
      const char* const value = std::getenv(name);
      values_.emplace_back(name, value != nullptr ? std::optional<std::string>(value) : std::nullopt);
    }
  }
  ~KeptEnvironment() {
    for (const auto& [name, value] : values_) {
      if (value)
        setenv(name.c_str(), value->c_str(), 1);
      else
        unsetenv(name.c_str());
    }
  }
  KeptEnvironment(const KeptEnvironment&) = delete;
  KeptEnvironment& operator=(const KeptEnvironment&) = delete;

 private:
  std::vector<std::pair<std::string, std::optional<std::string>>> values_;
};

}  // namespace occlod::test
