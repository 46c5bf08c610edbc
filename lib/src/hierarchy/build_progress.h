// Tells whoever waits for a build how far it is, and ends it when they want no more.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>

namespace occlod {

// Work is counted in any unit. The callback is only ever called by the thread that builds.
class BuildProgress {
 public:
  // How one thread reports. `calls_back`: it is the one that builds.
  class Reporter {
   public:
    Reporter(BuildProgress& progress, bool calls_back) : progress_(&progress), calls_back_(calls_back) {}
    // Counts work that has been done. False when the build is to end.
    [[nodiscard]] bool done(std::size_t work) { return progress_->done(work, calls_back_); }

   private:
    BuildProgress* progress_;
    bool calls_back_;
  };

  // Shares from `first` to `last` of the whole are told while `work` is being done.
  BuildProgress(const std::function<bool(double)>& callback, double first, double last, std::size_t work)
      : callback_(callback), first_(first), per_work_((last - first) / static_cast<double>(work)), last_(last) {}

  [[nodiscard]] bool is_cancelled() const noexcept { return is_cancelled_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds interval{20};

  bool done(std::size_t work, bool calls_back) {
    done_ += work;
    if (!callback_ || !calls_back || is_cancelled_) return !is_cancelled_;
    const auto now = Clock::now();
    if (now < next_call_) return true;
    next_call_ = now + interval;
    try {
      if (!callback_(std::min(first_ + per_work_ * static_cast<double>(done_), last_))) is_cancelled_ = true;
    } catch (...) {
      is_cancelled_ = true;  // or the other threads would go on to the end
      throw;
    }
    return !is_cancelled_;
  }

  const std::function<bool(double)>& callback_;
  double first_, per_work_, last_;
  std::atomic<std::size_t> done_ = 0;
  std::atomic<bool> is_cancelled_ = false;
  Clock::time_point next_call_{};
};

}  // namespace occlod
