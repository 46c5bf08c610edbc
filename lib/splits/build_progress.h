// Reports the progress of a build and cancels the build when the callback asks for it.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>

#include "occlod/base.h"

namespace occlod {

// Calls the callback only from the building thread, with shares that never decrease: at most every 20 ms, or sooner
// when another twentieth is done.
class BuildProgress {
 public:
  explicit BuildProgress(const std::function<bool(double)>& callback) : callback_(callback) {}

  // Returns whether the build was cancelled. Any thread may call it.
  [[nodiscard]] bool is_cancelled() const noexcept { return is_cancelled_; }

  // Reports that this share is done; only the building thread may call it. Throws Error when the callback cancels the
  // build, and rethrows whatever the callback throws; in both cases is_cancelled() is true afterwards.
  void reach(double share) {
    if (!callback_) return;
    const auto now = Clock::now();
    if (now < next_call_ && share < last_share_ + 0.05) return;
    next_call_ = now + std::chrono::milliseconds(20);
    last_share_ = std::clamp(share, last_share_, 1.0);
    try {
      if (!callback_(last_share_)) throw Error({"build", "", "was cancelled", ""});
    } catch (...) {
      is_cancelled_ = true;  // otherwise the other threads would run to the end
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

// Maps one piece of work to its part of the whole. The caller chooses the unit of `done`.
struct ProgressPart {
  BuildProgress& progress;
  double first = 0.0, last = 1.0;  // shares of the whole
  double total = 1.0;              // amount of work, in the unit of `done`

  void reach(std::size_t done) const {
    progress.reach(first + (last - first) * std::min(static_cast<double>(done) / total, 1.0));
  }
};

}  // namespace occlod
