// Strategy::automatic: which strategy draws the next frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "occlod/traverse/traverser.h"

namespace occlod::hlod {

// Tries each strategy now and then for two frames, of which the second counts: the seldomer the worse it has been. All
// other frames are drawn by the one that took least. Times are modelled, so choices depend on counts only.
class StrategyChoice {
 public:
  static constexpr std::array<Strategy, 4> candidates{Strategy::vfc, Strategy::batch, Strategy::nohc, Strategy::coh};

  // For the next frame: index into `candidates`.
  [[nodiscard]] std::size_t next();
  // What that frame took.
  void note(double frame_ms);
  void write_forecasts(std::vector<StrategyForecast>& forecasts) const;

 private:
  struct Candidate {
    double frame_ms = 0.0;
    std::uint32_t frame = 0;     // of frame_ms; 0: never tried
    std::uint32_t next_try = 0;  // frame
  };
  [[nodiscard]] std::size_t best() const;
  void end_trial();

  std::array<Candidate, 4> known_;
  std::uint32_t frame_ = 0;  // the next one is frame_ + 1
  std::size_t current_ = 0;  // of `candidates`
  std::size_t chosen_ = 0;   // outside of trials
  int trial_frames_ = 0;     // that are left
};

}  // namespace occlod::hlod
