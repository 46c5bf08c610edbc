// What tests of traversal draw with.
#pragma once

#include "occlod/traverser.h"

namespace occlod::hlod::test {

[[nodiscard]] inline TraverseOptions with(Strategy strategy, double tolerance_px) {
  TraverseOptions options;
  options.strategy = strategy;
  options.tolerance_px = tolerance_px;
  return options;
}

}  // namespace occlod::hlod::test
