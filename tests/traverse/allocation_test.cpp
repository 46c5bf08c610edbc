// A program of its own, with an operator new of its own.
#include <gtest/gtest.h>

#include <cstddef>

#include "occlod/device.h"
#include "occlod/device_costs.h"
#include "papers/trial_devices.h"
#include "support/counted_allocations.h"
#include "traverse/small_scenes.h"

namespace occlod::hlod {
namespace {

// Everything is kept from frame to frame and grows only to new largest sizes: a path that has been gone along needs no
// memory that it has not had. Not so with batch and automatic, which choose how to ask by what they asked before.
TEST(Allocations, NoFrameOfAPathThatIsKnownAllocates) {
  const Hlod& hlod = test::city(Grouping::shifted);
  const PlacedHlod placed[] = {
      {&hlod}, {&hlod, glm::dmat4(2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0)}};
  for (const TrialStrategy strategy :
       {TrialStrategy::vfc, TrialStrategy::sw, TrialStrategy::sw_b, TrialStrategy::boolean, TrialStrategy::simp,
        TrialStrategy::coh, TrialStrategy::ideal, TrialStrategy::nohc, TrialStrategy::optimum, TrialStrategy::chc_plus,
        TrialStrategy::two_pass, TrialStrategy::cesium}) {
    SoftwareDevice device, oracle;
    TrialTraverser traverser(placed);
    TrialOptions options;
    options.strategy = strategy;
    options.oracle = &oracle;
    options.costs = device_preset("modern");
    options.geomorph = true;
    constexpr int frames = 12;
    std::size_t allocated = 0;
    for (int way = 0; way < 3; ++way) {
      allocated = 0;
      for (int i = 0; i < frames; ++i) {
        const View view(test::walk(hlod.data().box, i, 100));
        const std::size_t before = occlod::test::allocation_count();
        traverser.draw_frame(view, device, options);
        allocated += occlod::test::allocation_count() - before;
      }
      EXPECT_TRUE(way > 0 || allocated > 0U);
    }
    EXPECT_EQ(allocated, 0U) << static_cast<int>(strategy);
  }
}

}  // namespace
}  // namespace occlod::hlod
