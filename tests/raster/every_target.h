// Runs something once for every instruction set that this machine has.
#pragma once

#include <hwy/targets.h>

#include <cstdint>

namespace occlod::test {

// Calls run(name of the instruction set), plain C++ included, and then leaves the best one chosen.
template <class Run>
void for_every_target(Run run) {
  for (std::int64_t left = hwy::SupportedTargets() | HWY_SCALAR | HWY_EMU128; left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    hwy::GetChosenTarget().Update(target);
    run(hwy::TargetName(target));
  }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace occlod::test
