// What tests of traversal draw with.
#pragma once

#include "papers/trial_traverser.h"

namespace occlod::hlod::test {

[[nodiscard]] inline TrialOptions with(TrialStrategy strategy, double tolerance_px) {
  TrialOptions options;
  options.strategy = strategy;
  options.tolerance_px = tolerance_px;
  return options;
}

}  // namespace occlod::hlod::test
