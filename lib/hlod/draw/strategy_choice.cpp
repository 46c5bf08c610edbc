#include "hlod/draw/strategy_choice.h"

#include <algorithm>

namespace occlod::hlod {
namespace {

constexpr double trial_share = 0.005;    // of the time, at most, for trials
constexpr std::uint32_t first_try = 16;  // frame: before, batch has yet to learn what is hidden
constexpr std::uint32_t least_wait = 32, most_wait = 1024;
constexpr double clearly = 0.97;  // the other one is taken where it needs so much less
constexpr double settling = 0.5;  // share of a new time in the usual one

// What is hidden takes batch some frames to find out, and they do not count; vfc need not know.
int trial_length(Strategy strategy) { return strategy == Strategy::vfc ? 1 : 4; }

}  // namespace

std::size_t StrategyChoice::next() {
  ++frame_;
  if (next_try_ == 0) next_try_ = first_try;
  const std::size_t other = 1 - chosen_;
  if (trial_frames_ == 0 && frame_ >= next_try_) trial_frames_ = trial_length(candidates[other]);
  return trial_frames_ > 0 ? other : chosen_;
}

void StrategyChoice::note(double frame_ms) {
  if (trial_frames_ > 0) {
    if (--trial_frames_ == 0) end_trial(frame_ms);
    return;
  }
  usual_ms_ = usual_ms_ > 0.0 ? usual_ms_ + settling * (frame_ms - usual_ms_) : frame_ms;
}

void StrategyChoice::end_trial(double frame_ms) {
  const std::size_t other = 1 - chosen_;
  tried_ = frame_;
  ratio_ = usual_ms_ > 0.0 ? frame_ms / usual_ms_ : 1.0;
  if (ratio_ < clearly) {
    chosen_ = other;
    usual_ms_ = frame_ms;
    ratio_ = 1.0 / ratio_;
  }
  const double wait = trial_length(candidates[1 - chosen_]) * (ratio_ - 1.0) / trial_share;
  next_try_ = frame_ + static_cast<std::uint32_t>(std::clamp(wait, double{least_wait}, double{most_wait}));
}

void StrategyChoice::write_forecasts(std::vector<StrategyForecast>& forecasts) const {
  forecasts.clear();
  if (usual_ms_ > 0.0) forecasts.push_back({candidates[chosen_], usual_ms_, 0});
  if (tried_ > 0) forecasts.push_back({candidates[1 - chosen_], ratio_ * usual_ms_, frame_ - tried_});
}

}  // namespace occlod::hlod
