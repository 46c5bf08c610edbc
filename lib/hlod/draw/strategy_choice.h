// Chooses for Strategy::automatic which strategy draws the next frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "occlod/traverser.h"

namespace occlod::hlod {

// Chooses between batch, which predicts like coh and asks only what pays off like nohc, and no queries at all: neither
// coh nor nohc was found clearly faster anywhere (docs/benchmarks/culling.md). The other candidate is tried now and
// then, the less often the worse it was, and is chosen when it takes clearly less time than the frames just before.
// Times are modelled, so choices depend on counts only.
class StrategyChoice {
 public:
  static constexpr std::array<Strategy, 2> candidates{Strategy::batch, Strategy::vfc};

  // Returns the index into `candidates` for the next frame.
  [[nodiscard]] std::size_t next();
  // Records the time of that frame.
  void note(double frame_ms);
  void write_forecasts(std::vector<StrategyForecast>& forecasts) const;

 private:
  void end_trial(double frame_ms);

  std::uint32_t frame_ = 0;     // number of the last frame
  std::size_t chosen_ = 0;      // index outside of trials
  double usual_ms_ = 0.0;       // time of the chosen strategy
  double ratio_ = 0.0;          // time of the other strategy, when tried, relative to usual_ms_
  std::uint32_t tried_ = 0;     // frame of the last trial; 0: none
  std::uint32_t next_try_ = 0;  // frame of the next trial; 0: not decided yet
  int trial_frames_ = 0;        // frames that are left of the trial
};

}  // namespace occlod::hlod
