// Reports the progress of a build, and ends it when the callback asks for that.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>

#include "occlod/base.h"

namespace occlod {

// The callback is only ever called by the thread that builds, with shares that never fall: after 20 ms, or sooner when
// a twentieth more is done.
class BuildProgress {
 public:
  explicit BuildProgress(const std::function<bool(double)>& callback) : callback_(callback) {}

  // For any thread: whether to go on.
  [[nodiscard]] bool is_cancelled() const noexcept { return is_cancelled_; }

  // For the thread that builds: so much is done. Throws Error when the callback says that the build is to end, after
  // which is_cancelled(), and whatever the callback throws, likewise.
  void reach(double share) {
    if (!callback_) return;
    const auto now = Clock::now();
    if (now < next_call_ && share < last_share_ + 0.05) return;
    next_call_ = now + std::chrono::milliseconds(20);
    last_share_ = std::clamp(share, last_share_, 1.0);
    try {
      if (!callback_(last_share_)) throw Error({"build", "", "was cancelled", ""});
    } catch (...) {
      is_cancelled_ = true;  // or the other threads would go on to the end
      throw;
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  const std::function<bool(double)>& callback_;
  std::atomic<bool> is_cancelled_ = false;
  double last_share_ = 0.0;
  Clock::time_point next_call_{};
};

// The part of the whole that one piece of work is. `done` and its unit are the caller's.
struct ProgressPart {
  BuildProgress& progress;
  double first = 0.0, last = 1.0;  // shares of the whole
  double total = 1.0;              // what there is to do

  void reach(std::size_t done) const {
    progress.reach(first + (last - first) * std::min(static_cast<double>(done) / total, 1.0));
  }
};

}  // namespace occlod
