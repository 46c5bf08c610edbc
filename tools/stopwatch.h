// Measures wall time.
#pragma once

#include <chrono>

namespace occlod::tool {

class Stopwatch {
 public:
  [[nodiscard]] double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }
  // Returns the time so far, in ms, and restarts from 0.
  double restart() {
    const double elapsed = milliseconds();
    *this = {};
    return elapsed;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace occlod::tool
