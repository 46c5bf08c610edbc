// Checks of generator options, which come from scene files and command lines.
#pragma once

namespace occlod {

class OptionChecker {
 public:
  // `generator` names the subject of errors and outlives the checker.
  explicit OptionChecker(const char* generator) noexcept : generator_(generator) {}

  // Throws Error unless low <= value <= high (NaN fails).
  void in_range(const char* option, double value, double low, double high) const;

 private:
  const char* generator_;
};

}  // namespace occlod
