#include <gtest/gtest.h>

#include <vector>

#include "refine/occluder.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

// Splits one by one, each of two triangles and the given error: at which of them the occluder is drawn.
std::vector<std::size_t> draws(const RefineOptions& options, std::size_t splits, float error_px) {
  OccluderSteps steps;
  steps.begin(options);
  std::vector<std::size_t> drawn;
  for (std::size_t n = 1; n <= splits; ++n) {
    steps.split_applied(error_px);
    if (!steps.due({n, 2 * n})) continue;
    drawn.push_back(n);
    steps.drawn({n, 2 * n});
  }
  return drawn;
}

TEST(OccluderSteps, GivenStepsAreKept) {
  RefineOptions options;
  tune(options).occluder_splits = {300, 2500};
  EXPECT_EQ(draws(options, 5000, 0.0F), (std::vector<std::size_t>{300, 2500}));
  tune(options).occluder_splits = {10'000};
  EXPECT_TRUE(draws(options, 5000, 100.0F).empty());
}

TEST(OccluderSteps, AnExtraDrawDoesNotUseUpALaterStep) {
  RefineOptions options;
  tune(options).occluder_splits = {300, 2500};
  OccluderSteps steps;
  steps.begin(options);
  steps.drawn({100, 100});  // since all that was left was hidden
  EXPECT_TRUE(steps.due({300, 300}));
  steps.drawn({2600, 2600});  // one that is late is both
  EXPECT_FALSE(steps.due({3000, 3000}));
}

// However many splits, the draws are a geometric series, of which a third of the budget is a member: their sum is at
// most 6 / 5 of the last.
TEST(OccluderSteps, AdaptiveStepsArePartsOfTheBudget) {
  RefineOptions options;
  options.budget = 18'000;
  EXPECT_EQ(draws(options, 20'000, 2.0F), (std::vector<std::size_t>{84, 500, 3000, 18'000}));
  options.budget = 3'600;  // even where the first of two is small
  EXPECT_EQ(draws(options, 1000, 2.0F), (std::vector<std::size_t>{100, 600}));
  options.budget = 900;
  EXPECT_EQ(draws(options, 1000, 2.0F), (std::vector<std::size_t>{25, 150, 900}));
  for (const std::size_t budget : {1U, 96U}) {
    options.budget = budget;
    EXPECT_EQ(draws(options, 500, 2.0F), (std::vector<std::size_t>{16, 96})) << budget;
  }
}

TEST(OccluderSteps, AdaptiveStepsCountTriangles) {
  // A split that brings a whole component back brings many: a budget may be used up after a few of them.
  OccluderSteps steps;
  const RefineOptions options;
  steps.begin(options);
  steps.split_applied(50.0F);
  EXPECT_FALSE(steps.due({100, 100}));
  EXPECT_TRUE(steps.due({10, 600}));
}

TEST(OccluderSteps, AdaptiveStepsEndWhenNothingMovesByAPixel) {
  EXPECT_TRUE(draws({}, 100'000, 0.9F).empty());
  OccluderSteps steps;
  const RefineOptions options;
  steps.begin(options);
  steps.split_applied(50.0F);
  EXPECT_TRUE(steps.due({1000, 1000}));
  steps.drawn({1000, 1000});
  EXPECT_FALSE(steps.due({100'000, 100'000}));  // nothing has moved since
  steps.split_applied(1.5F);
  EXPECT_TRUE(steps.due({100'000, 100'000}));
}

}  // namespace
}  // namespace occlod
