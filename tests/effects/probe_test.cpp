#include "effects/probe.h"

#include <gtest/gtest.h>

#include "effect_scenes.h"

namespace occlod::test {
namespace {

RefineOptions some_budget() {
  RefineOptions options;
  options.budget = 5'000;
  return options;
}

// Nothing is behind anything else.
TEST(Probe, FindsNothingHiddenInTheOpen) {
  const Hierarchy ground = open_ground();
  const RefineObject objects[] = {{.hierarchy = &ground}};
  Probe probe(objects);
  const HiddenShares shares = probe.look_ahead(above_ground(), some_budget()).all;
  EXPECT_GT(shares.visits, 0U);
  EXPECT_LT(shares.splits_hidden, 0.05);
  EXPECT_LT(shares.visits_hidden, 0.05);
}

// Nearly all errors are the spheres', and all of these are behind the wall, the coarse one as the fine one.
TEST(Probe, FindsWhatAWallHides) {
  const Hierarchy scene = wall_with_spheres();
  const RefineObject objects[] = {{.hierarchy = &scene}};
  Probe probe(objects);
  const HiddenShares ahead = probe.look_ahead(before_wall(), some_budget()).all;
  EXPECT_GT(ahead.splits, 0U);
  EXPECT_GT(ahead.splits_hidden, 0.7);
  EXPECT_GE(ahead.stars_hidden, ahead.splits_hidden);
  Refiner refiner(objects);
  NoOcclusion none;
  const Refinement& refinement = refiner.refine(before_wall(), some_budget(), none);
  EXPECT_GT(probe.look_back(before_wall(), some_budget(), refinement, refinement.stats.level_px).all.splits_hidden,
            0.7);
}

TEST(Probe, IsTheSameEveryTime) {
  const Hierarchy scene = wall_with_spheres();
  const RefineObject objects[] = {{.hierarchy = &scene}};
  Probe a(objects), b(objects);
  const View view = view_at({2.0, 2.0, 0.5}, {-0.5, 0.0, 0.0});
  const HiddenShares first = a.look_ahead(view, some_budget()).all;
  (void)b.look_ahead(before_wall(), some_budget());
  const HiddenShares second = b.look_ahead(view, some_budget()).all;
  EXPECT_EQ(first.visits, second.visits);
  EXPECT_EQ(first.splits_hidden, second.splits_hidden);
  EXPECT_EQ(first.stars_hidden, second.stars_hidden);
}

}  // namespace
}  // namespace occlod::test
