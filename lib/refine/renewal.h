// What looks back find beyond looks ahead.
#pragma once

#include <algorithm>
#include <cmath>

#include "occlod/effects/effect_choice.h"

namespace occlod {

// How much more the refined mesh hides than a coarse one, and how much more it fills the image: from places where both
// have been looked at, for those where only a coarse one has been.
class Renewal {
 public:
  void learn(const HiddenShares& ahead, const HiddenShares& back) {
    const auto mix = [&](double& ratio, double now) { ratio = known_ ? std::sqrt(ratio * now) : now; };
    mix(visits_shown_, shown(back.visits_hidden) / shown(ahead.visits_hidden));
    mix(splits_shown_, shown(back.splits_hidden) / shown(ahead.splits_hidden));
    mix(stars_shown_, shown(back.stars_hidden) / shown(ahead.stars_hidden));
    mix(layers_, (1.0 + back.coverage.layers) / (1.0 + ahead.coverage.layers));
    mix(front_layers_, (1.0 + back.coverage.front_layers) / (1.0 + ahead.coverage.front_layers));
    front_share_ = back.coverage.front_share;
    known_ = true;
  }
  [[nodiscard]] bool known() const noexcept { return known_; }
  // What a look back would find where `ahead` has been found; until anything is known, the same.
  [[nodiscard]] HiddenShares of(HiddenShares ahead) const {
    ahead.visits_hidden = hidden(visits_shown_ * shown(ahead.visits_hidden));
    ahead.splits_hidden = hidden(splits_shown_ * shown(ahead.splits_hidden));
    ahead.stars_hidden = std::max(hidden(stars_shown_ * shown(ahead.stars_hidden)), ahead.splits_hidden);
    Coverage& coverage = ahead.coverage;
    coverage.layers = (1.0 + coverage.layers) * layers_ - 1.0;
    coverage.front_layers = (1.0 + coverage.front_layers) * front_layers_ - 1.0;
    coverage.front_share = front_share_;
    return ahead;
  }

 private:
  static constexpr double least_shown = 0.05;
  [[nodiscard]] static double shown(double hidden) { return std::max(1.0 - hidden, least_shown); }
  [[nodiscard]] static double hidden(double shown) { return std::clamp(1.0 - shown, 0.0, 1.0 - least_shown); }

  bool known_ = false;
  double visits_shown_ = 1.0, splits_shown_ = 1.0, stars_shown_ = 1.0;
  double layers_ = 1.0, front_layers_ = 1.0, front_share_ = 1.0;
};

}  // namespace occlod
