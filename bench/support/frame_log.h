// What one way to refine took in every frame of a path.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <span>
#include <vector>

#include "occlod/refiner.h"
#include "stopwatch.h"

namespace occlod::bench {

struct FrameTime {
  double ms = 0.0;  // on the clock
  double cpu_ms =
      0.0;  // of the processor: where others want it too, the clock counts long calls longer than short ones
};

class FrameTimer {
 public:
  [[nodiscard]] FrameTime elapsed() const {
    return {stopwatch_.milliseconds(), 1e3 * static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC};
  }

 private:
  tool::Stopwatch stopwatch_;
  std::clock_t start_ = std::clock();
};

struct FrameLog {
  std::vector<double> ms, cpu_ms, changes;  // of each frame
  std::size_t triangles = 0;                // of the last
  std::uint64_t hash = 0;                   // of all

  void add(const FrameTime& time, std::size_t frame_changes, std::size_t frame_triangles, std::uint64_t frame_hash) {
    ms.push_back(time.ms);
    cpu_ms.push_back(time.cpu_ms);
    changes.push_back(static_cast<double>(frame_changes));
    triangles = frame_triangles;
    hash = hash * 31 + frame_hash;
  }
};

// A Refiner's frames.
struct RefinerLog {
  explicit RefinerLog(std::span<const RefineObject> objects) : refiner(objects) {}

  Refiner refiner;
  const Refinement* last = nullptr;
  FrameLog log;

  // From the base mesh, or from the frame before.
  void step(const View& view, const RefineOptions& options, Visibility& visibility, bool goes_on) {
    const FrameTimer timer;
    last = goes_on ? &refiner.update(view, options, visibility) : &refiner.refine(view, options, visibility);
    const FrameTime time = timer.elapsed();
    const RefineStats& stats = last->stats;
    log.add(time, stats.new_splits + stats.merged_splits, stats.triangles, last->hash());
  }
};

// Of the values but the first, which starts from nothing.
[[nodiscard]] inline double later_percentile(const std::vector<double>& values, double part) {
  std::vector<double> later(values.begin() + 1, values.end());
  std::sort(later.begin(), later.end());
  return later[static_cast<std::size_t>(part * static_cast<double>(later.size() - 1))];
}

// The most values in a row, but for the first, that are above `factor` medians.
[[nodiscard]] inline std::size_t longest_run_above(const std::vector<double>& values, double factor) {
  const double limit = factor * later_percentile(values, 0.5);
  std::size_t run = 0, longest = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    run = values[i] > limit ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

}  // namespace occlod::bench
