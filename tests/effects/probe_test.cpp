#include "refine/probe.h"

#include <gtest/gtest.h>

#include <algorithm>

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
  const Hierarchy scene = build_hierarchy(generate("spheres-behind-wall", {{"spheres", 32}, {"level", 4}}));
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

// The wall is two triangles, which nothing refines, so the rest is hidden whole; and a quarter of the splits of a
// height field have twice the error: about four times as many for each halving, less where it ends.
TEST(Probe, CountsHowMuchFinerWhatIsVisibleCanBecome) {
  const Hierarchy ground = build_hierarchy(generate("rough-planet", {{"level", 6}}));
  const RefineObject objects[] = {{.hierarchy = &ground}};
  Probe probe(objects);
  RefineOptions options;
  options.budget = 2'000;
  const View view = view_at({3.0, 0.0, 0.0}, {0.0, 0.0, 0.0});
  const double growth = probe.look_ahead(view, options).all.growth;
  EXPECT_GT(growth, 2.0);
  EXPECT_LT(growth, 8.0);
}

// Near the ground most nodes with large errors are nearly edge-on and worth little themselves: the splits that are
// applied are above them.
TEST(Probe, FindsSplitsNearTheGround) {
  const Hierarchy planet = build_hierarchy(generate("rough-planet", {{"level", 7}}));
  const RefineObject objects[] = {{.hierarchy = &planet}};
  Probe probe(objects);
  RefineOptions options;
  options.budget = 4'000;
  const View view = view_at({1.05, 0.0, 0.0}, {1.0, 0.5, 0.0});
  const HiddenShares ahead = probe.look_ahead(view, options).all;
  EXPECT_GT(3 * ahead.splits, ahead.visits);
}

// Refinement without occlusion ends where the walks say, within a factor of two, although they know no forced splits
// and not how much of a star is seen.
TEST(Probe, KnowsWhereTheBudgetEnds) {
  const Hierarchy planet = build_hierarchy(generate("rough-planet", {{"level", 6}}));
  const RefineObject objects[] = {{.hierarchy = &planet}};
  Probe probe(objects);
  Refiner refiner(objects);
  NoOcclusion none;
  const View view = view_at({3.0, 0.0, 0.0}, {0.0, 0.0, 0.0});
  for (const std::size_t budget : {500U, 1'000U, 2'000U}) {
    RefineOptions options;
    options.budget = budget;
    (void)probe.look_ahead(view, options);
    const double level = refiner.refine(view, options, none).stats.level_px;
    EXPECT_GT(probe.level_ahead_px(), 0.5 * level) << budget;
    EXPECT_LT(probe.level_ahead_px(), 2.0 * level) << budget;
  }
}

// From (3, ..), the wall covers the middle of the image once and nothing else is in front of it.
TEST(Probe, CountsHowOftenTheImageIsCovered) {
  const Hierarchy scene = wall_with_spheres();
  const RefineObject objects[] = {{.hierarchy = &scene}};
  Probe probe(objects);
  Refiner refiner(objects);
  NoOcclusion none;
  const Refinement& refinement = refiner.refine(before_wall(), some_budget(), none);
  const Coverage coverage =
      probe.look_back(before_wall(), some_budget(), refinement, refinement.stats.level_px).all.coverage;
  EXPECT_GE(coverage.layers, coverage.front_layers);
  EXPECT_GT(coverage.front_layers, 0.2);
  EXPECT_LT(coverage.layers, 3.0);
  EXPECT_GT(coverage.front_share, 0.4);  // spheres are closed: half of them faces the eye
  EXPECT_LE(coverage.front_share, 1.0);
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
