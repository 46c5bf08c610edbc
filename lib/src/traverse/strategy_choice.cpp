#include "traverse/strategy_choice.h"

#include <algorithm>

namespace occlod::hlod {
namespace {

constexpr double trial_share = 0.005;  // of the time, at most, for trials of one strategy
constexpr std::uint32_t least_wait = 32, most_wait = 1024;
constexpr double clearly = 0.97;   // another one is taken where it needs so much less
constexpr double settling = 0.25;  // share of a new time in the average of the chosen one

// What was visible is known after one frame; vfc need not know.
int trial_length(Strategy strategy) { return strategy == Strategy::vfc ? 1 : 2; }

}  // namespace

std::size_t StrategyChoice::best() const {
  std::size_t best = chosen_;
  for (std::size_t i = 0; i < known_.size(); ++i) {
    if (known_[i].frame == 0) continue;
    const double limit = known_[best].frame_ms * (best == chosen_ ? clearly : 1.0);
    if (known_[best].frame == 0 || known_[i].frame_ms < limit) best = i;
  }
  return best;
}

std::size_t StrategyChoice::next() {
  ++frame_;
  if (trial_frames_ == 0) {
    chosen_ = current_ = best();
    for (std::size_t i = 0; i < known_.size() && current_ == chosen_; ++i)
      if ((i != chosen_ || known_[i].frame == 0) && known_[i].next_try <= frame_) {
        current_ = i;
        trial_frames_ = trial_length(candidates[i]);
        break;
      }
  }
  return current_;
}

void StrategyChoice::note(double frame_ms) {
  Candidate& candidate = known_[current_];
  const bool is_trial = trial_frames_ > 0;
  if (is_trial && --trial_frames_ > 0) return;
  const bool is_new = is_trial || candidate.frame == 0;
  candidate.frame_ms = is_new ? frame_ms : candidate.frame_ms + settling * (frame_ms - candidate.frame_ms);
  candidate.frame = frame_;
  if (is_trial) end_trial();
}

void StrategyChoice::end_trial() {
  Candidate& candidate = known_[current_];
  const double excess = candidate.frame_ms / known_[best()].frame_ms - 1.0;
  const double wait = trial_length(candidates[current_]) * excess / trial_share;
  candidate.next_try = frame_ + static_cast<std::uint32_t>(std::clamp(wait, double{least_wait}, double{most_wait}));
}

void StrategyChoice::write_forecasts(std::vector<StrategyForecast>& forecasts) const {
  forecasts.clear();
  for (std::size_t i = 0; i < known_.size(); ++i)
    if (known_[i].frame > 0) forecasts.push_back({candidates[i], known_[i].frame_ms, frame_ - known_[i].frame});
}

}  // namespace occlod::hlod
