// Checks options, which come from programs, scene files and command lines.
#pragma once

namespace occlod {

// Each check throws Error unless the value is in the range that it names; NaN is in no range.
class OptionChecker {
 public:
  // `subject` says in errors what has these options; it must outlive the checker.
  explicit OptionChecker(const char* subject) noexcept : subject_(subject) {}

  void in_range(const char* option, double value, double low, double high) const;  // low <= value <= high
  void below(const char* option, double value, double low, double end) const;      // low <= value < end
  void at_least(const char* option, double value, double low) const;               // low <= value, finite
  void positive(const char* option, double value) const;                           // 0 < value, finite

 private:
  const char* subject_;
};

}  // namespace occlod
