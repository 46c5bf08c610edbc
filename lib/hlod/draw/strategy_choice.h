// Strategy::automatic: which strategy draws the next frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "occlod/traverser.h"

namespace occlod::hlod {

// Batch, which predicts as coh does and asks only what pays as nohc does, or nothing at all: neither of those has been
// found to be clearly faster anywhere (docs/benchmarks/hlod.md). The other one is tried now and then, the seldomer the
// worse it has been, and taken where it needs clearly less than the frames just before. Times are modelled, so choices
// depend on counts only.
class StrategyChoice {
 public:
  static constexpr std::array<Strategy, 2> candidates{Strategy::batch, Strategy::vfc};

  // For the next frame: index into `candidates`.
  [[nodiscard]] std::size_t next();
  // What that frame took.
  void note(double frame_ms);
  void write_forecasts(std::vector<StrategyForecast>& forecasts) const;

 private:
  void end_trial(double frame_ms);

  std::uint32_t frame_ = 0;     // the next one is frame_ + 1
  std::size_t chosen_ = 0;      // outside of trials
  double usual_ms_ = 0.0;       // what the chosen one takes
  double ratio_ = 0.0;          // of the other one's time to that, when it was tried
  std::uint32_t tried_ = 0;     // frame; 0: never
  std::uint32_t next_try_ = 0;  // frame; 0: not decided yet
  int trial_frames_ = 0;        // that are left
};

}  // namespace occlod::hlod
