#include "occlod/auto_refiner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "effect_scenes.h"
#include "occlod/base.h"
#include "occlod/visibility.h"
#include "refine/forecast.h"
#include "support/bad_options.h"

namespace occlod::test {
namespace {

AutoRefiner refiner_of(std::span<const RefineObject> objects) { return AutoRefiner(objects, round_calibration()); }

RefineOptions budget_of(std::size_t triangles) {
  RefineOptions options;
  options.budget = triangles;
  return options;
}

// From above no part of a gentle height field is behind another: every question would be answered "visible".
TEST(AutoRefiner, AsksNothingWhereNothingHides) {
  const Hierarchy ground = open_ground();
  const RefineObject objects[] = {{.hierarchy = &ground}};
  AutoRefiner refiner = refiner_of(objects);
  for (int i = 0; i < 4; ++i) {
    const Refinement& refinement = refiner.refine(above_ground(), budget_of(3'000));
    EXPECT_FALSE(refiner.report().choice.backend) << i;
    EXPECT_EQ(refinement.stats.queries, 0U);
    EXPECT_EQ(refinement.stats.occluder_draws, 0U);
  }
}

// Then it refines exactly as without occlusion.
TEST(AutoRefiner, IsTheSameAsNoOcclusionWhereNothingHides) {
  const Hierarchy ground = open_ground();
  const RefineObject objects[] = {{.hierarchy = &ground}};
  AutoRefiner refiner = refiner_of(objects);
  Refiner plain(objects);
  NoOcclusion none;
  EXPECT_EQ(refiner.refine(above_ground(), budget_of(3'000)).hash(),
            plain.refine(above_ground(), budget_of(3'000), none).hash());
}

// Everything but the wall and the ball before it is hidden: what is not asked about takes most of the budget, which the
// ball could use.
TEST(AutoRefiner, AsksWhereAWallHidesTheRest) {
  const Hierarchy scene = wall_with_spheres(128);
  const RefineObject objects[] = {{.hierarchy = &scene}};
  AutoRefiner refiner = refiner_of(objects);
  for (int i = 0; i < 3; ++i) {
    const Refinement& refinement = refiner.refine(before_wall(), budget_of(5'000));
    EXPECT_TRUE(refiner.report().choice.backend) << i;
    EXPECT_GT(refinement.stats.queries_hidden, 0U) << i;
  }
}

// From behind, the wall hides nothing and the spheres hide little; the eye has moved across the scene in between.
TEST(AutoRefiner, LooksAgainWhenTheCameraHasMoved) {
  const Hierarchy scene = wall_with_spheres(128);
  const RefineObject objects[] = {{.hierarchy = &scene}};
  AutoRefiner refiner = refiner_of(objects);
  (void)refiner.refine(before_wall(), budget_of(5'000));
  EXPECT_TRUE(refiner.report().looked_ahead);
  (void)refiner.refine(before_wall(), budget_of(5'000));
  EXPECT_FALSE(refiner.report().looked_ahead);  // it has not moved
  (void)refiner.refine(view_at({-4.0, 1.0, 1.0}, {0.0, 0.0, 0.0}), budget_of(5'000));
  EXPECT_TRUE(refiner.report().looked_ahead);
}

// A sphere seen from outside: the cone of a patch is narrow and half of all patches face away. The spikes of a rough
// one point everywhere, so that next to no subtree faces away as a whole.
TEST(AutoRefiner, UsesConesWhereTheyCull) {
  const Hierarchy smooth = build_hierarchy(octahedron_sphere(5));
  const Hierarchy rough =
      build_hierarchy(generate("rough-planet", {{"level", 5}, {"amplitude", 0.4}, {"frequency", 24.0}}));
  const RefineObject objects[] = {
      {.hierarchy = &smooth},
      {.hierarchy = &rough, .object_to_world = glm::translate(glm::dmat4(1.0), {0.0, 3.0, 0.0})}};
  AutoRefiner refiner = refiner_of(objects);
  const View view = view_at({7.0, 1.5, 0.0}, {0.0, 1.5, 0.0});
  (void)refiner.refine(view, budget_of(6'000));
  const ObjectEffectStats first_rough = refiner.report().objects[1];
  (void)refiner.refine(view, budget_of(6'000));
  EXPECT_TRUE(refiner.report().choice.objects[0].cones);
  EXPECT_FALSE(refiner.report().choice.objects[1].cones) << first_rough.cone_culled << " of " << first_rough.cone_tests;
  EXPECT_EQ(refiner.report().objects[1].cone_tests, 0U);
}

// One object is behind the wall of another, a third stands in the open beside them.
TEST(AutoRefiner, ChoosesObjectByObject) {
  const Hierarchy scene = wall_with_spheres(128);
  const Hierarchy ground = open_ground();
  const RefineObject objects[] = {
      {.hierarchy = &scene},
      {.hierarchy = &ground,
       .object_to_world = glm::rotate(glm::translate(glm::dmat4(1.0), {0.6, 0.1, -0.3}), 1.57, {0.0, 1.0, 0.0})}};
  AutoRefiner refiner = refiner_of(objects);
  const View view = before_wall();
  for (int i = 0; i < 3; ++i) (void)refiner.refine(view, budget_of(6'000));
  const EffectReport& report = refiner.report();
  ASSERT_TRUE(report.choice.backend);
  const ObjectEffects& open = report.choice.objects[1];
  EXPECT_TRUE(!open.occlusion || open.regions == 0) << report.objects[1].queries();
  EXPECT_GT(report.objects[0].queries(), 0U);
  EXPECT_EQ(report.objects[1].queries(), 0U);
}

// Choices depend on counts and on the calibration alone.
TEST(AutoRefiner, SameCalibrationSameMeshes) {
  const Hierarchy scene = wall_with_spheres(128);
  const RefineObject objects[] = {{.hierarchy = &scene}};
  AutoRefiner a = refiner_of(objects), b = refiner_of(objects);
  for (int i = 0; i < 40; ++i) {  // past one look_interval
    const View view = view_at({1.0 + 0.1 * i, 0.05 * i, 0.05}, {-1.0, 0.0, 0.0});
    ASSERT_EQ(a.refine(view, budget_of(4'000)).hash(), b.refine(view, budget_of(4'000)).hash()) << i;
    ASSERT_EQ(a.report().choice, b.report().choice) << i;
  }
}

// A choice is data: a Refiner that is given it comes to the same mesh.
TEST(AutoRefiner, ChoicesCanBeReplayed) {
  const Hierarchy scene = wall_with_spheres(128);
  const RefineObject objects[] = {{.hierarchy = &scene}};
  AutoRefiner refiner = refiner_of(objects);
  Refiner plain(objects);
  const std::unique_ptr<Visibility> software = make_software_occlusion();
  for (int i = 0; i < 3; ++i) {
    const std::uint64_t hash = refiner.refine(before_wall(), budget_of(5'000)).hash();
    const EffectChoice choice = refiner.report().choice;
    ASSERT_TRUE(choice.backend);
    std::shared_ptr<const Tuning> tuning;
    const RefineOptions options = with_choice(budget_of(5'000), choice, tuning);
    EXPECT_EQ(plain.refine(before_wall(), options, *software).hash(), hash) << i;
  }
}

// Frame to frame nothing is asked where nothing hides, and the frames are those without occlusion.
TEST(AutoRefiner, FramesAreThoseWithoutOcclusionWhereNothingHides) {
  const Hierarchy ground = open_ground();
  const RefineObject objects[] = {{.hierarchy = &ground}};
  AutoRefiner refiner = refiner_of(objects);
  Refiner plain(objects);
  NoOcclusion none;
  for (int i = 0; i < 100; ++i) {  // past one look_interval
    const View view = view_at({0.45 + 0.001 * i, 0.49, 1.5}, {0.45 + 0.001 * i, 0.5, 0.0});
    const Refinement& refinement = refiner.update(view, budget_of(3'000));
    EXPECT_EQ(refinement.stats.occluder_draws, 0U) << i;
    ASSERT_EQ(refinement.hash(), plain.update(view, budget_of(3'000), none).hash()) << i;
  }
}

// Where a wall hides the rest, all frames ask, and after the first they go on from each other; another choice of
// effects, here of regions in which nothing was hidden, does not begin anew.
TEST(AutoRefiner, FramesGoOnWhileEffectsChange) {
  const Hierarchy scene = wall_with_spheres(128);
  const RefineObject objects[] = {{.hierarchy = &scene}};
  AutoRefiner refiner = refiner_of(objects);
  std::optional<EffectChoice> last;
  bool has_changed = false;
  for (int i = 0; i < 40; ++i) {
    const View view = view_at({3.0, 0.05 + 0.002 * i, 0.05}, {-1.0, 0.0, 0.0});
    const RefineStats stats = refiner.update(view, budget_of(1'500)).stats;
    const EffectReport& report = refiner.report();
    EXPECT_TRUE(report.choice.backend) << i;
    EXPECT_LE(stats.triangles, 1'500U);
    EXPECT_EQ(stats.new_splits == stats.splits, i == 0) << i;
    EXPECT_EQ(report.objects[0].queries(), stats.queries) << i;
    EXPECT_EQ(report.objects[0].hidden(), stats.queries_hidden) << i;
    has_changed = has_changed || (last && *last != report.choice);
    last = report.choice;
  }
  EXPECT_TRUE(has_changed);
}

// What is asked may change from frame to frame between nothing and everything, and the mesh is kept all the same.
TEST(AutoRefiner, FramesGoOnWhenQueriesEnd) {
  const Hierarchy scene = wall_with_spheres(128);
  const RefineObject objects[] = {{.hierarchy = &scene}};
  AutoRefiner refiner = refiner_of(objects);
  std::optional<bool> last;
  int changes = 0;
  for (int i = 0; i < 240; ++i) {
    const double angle = 0.0131 * i;  // from before the wall to behind it, where the spheres are seen
    const View view = view_at({3.0 * std::cos(angle), 3.0 * std::sin(angle), 0.05}, {-0.5, 0.0, 0.0});
    const RefineStats stats = refiner.update(view, budget_of(1'500)).stats;
    const bool asks = refiner.report().choice.backend.has_value();
    if (last && *last != asks) {
      ++changes;
      EXPECT_LT(stats.new_splits, stats.splits / 2) << i;
    }
    last = asks;
  }
  EXPECT_GT(changes, 0);
}

// A view that stands comes to rest: no looks, the same choice, in the end the same mesh.
TEST(AutoRefiner, AStillViewComesToRest) {
  const Hierarchy scene = wall_with_spheres(128);
  const RefineObject objects[] = {{.hierarchy = &scene}};
  AutoRefiner refiner = refiner_of(objects);
  (void)refiner.update(before_wall(), budget_of(5'000));
  const EffectChoice choice = refiner.report().choice;
  RefineStats stats;
  for (int i = 0; i < 40; ++i) {
    stats = refiner.update(before_wall(), budget_of(5'000)).stats;
    EXPECT_EQ(refiner.report().choice, choice) << i;
    EXPECT_FALSE(refiner.report().looked_ahead || refiner.report().looked_back) << i;
    EXPECT_EQ(refiner.report().look_ms, 0.0);
  }
  EXPECT_EQ(stats.new_splits + stats.merged_splits + stats.occluder_draws, 0U);
}

// The camera stands still: what has been moved far is looked at anew, and is no longer at rest; and where nothing hides
// a moved object is refined as if it had been there from the beginning.
TEST(AutoRefiner, LooksAgainWhenAnObjectHasMoved) {
  const Hierarchy ground = open_ground();
  RefineObject objects[] = {{.hierarchy = &ground}};
  AutoRefiner refiner = refiner_of(objects);
  (void)refiner.refine(above_ground(), budget_of(3'000));
  (void)refiner.refine(above_ground(), budget_of(3'000));
  EXPECT_FALSE(refiner.report().looked_ahead);
  const glm::vec3 size = ground.box().max - ground.box().min;
  objects[0].object_to_world[3] = glm::dvec4(0.3 * static_cast<double>(size.x), 0.0, 0.0, 1.0);
  refiner.set_transform(0, objects[0].object_to_world);
  const std::uint64_t moved = refiner.refine(above_ground(), budget_of(3'000)).hash();
  EXPECT_TRUE(refiner.report().looked_ahead);
  EXPECT_EQ(moved, refiner_of(objects).refine(above_ground(), budget_of(3'000)).hash());
  for (int i = 0; i < 20; ++i) (void)refiner.update(above_ground(), budget_of(3'000));
  refiner.set_transform(0, glm::dmat4(1.0));
  EXPECT_GT(refiner.update(above_ground(), budget_of(3'000)).stats.new_splits, 0U);
}

// A camera that crosses the scene in every frame would look ahead in each: it does not in two that follow each other.
TEST(AutoRefiner, LooksAreRareWhateverTheCameraDoes) {
  const Hierarchy scene = wall_with_spheres(128);
  const RefineObject objects[] = {{.hierarchy = &scene}};
  AutoRefiner refiner = refiner_of(objects);
  int looks = 0;
  for (int i = 0; i < 40; ++i) {
    const double side = i % 2 == 0 ? 3.0 : -4.0;
    (void)refiner.update(view_at({side, 0.05, 0.05}, {0.0, 0.0, 0.0}), budget_of(5'000));
    looks += refiner.report().looked_ahead ? 1 : 0;
  }
  EXPECT_LE(looks, 2);
}

// A camera that jumps in every view over ground that hides nothing: after three looks ahead that changed nothing only
// every fourth view has one. Where a wall hides nearly everything from some views, these are looked at each time.
TEST(AutoRefiner, LooksBecomeRareWhereTheyChangeNothing) {
  const Hierarchy ground = open_ground();
  const RefineObject objects[] = {{.hierarchy = &ground}};
  AutoRefiner refiner = refiner_of(objects);
  std::vector<bool> looks;
  for (int i = 0; i < 19; ++i) {
    const double x = 0.1 + 0.2 * (i % 5);
    (void)refiner.refine(view_at({x, 0.49, 1.5}, {x, 0.5, 0.0}), budget_of(3'000));
    EXPECT_FALSE(refiner.report().choice.backend) << i;
    looks.push_back(refiner.report().looked_ahead);
  }
  EXPECT_EQ(std::count(looks.begin(), looks.begin() + 3, true), 3);
  EXPECT_GE(std::count(looks.begin() + 11, looks.end(), true), 2);
  EXPECT_LE(std::count(looks.begin() + 11, looks.end(), true), 3);
}

TEST(AutoRefiner, KeepsTheBudget) {
  const Hierarchy scene = wall_with_spheres(128);
  const RefineObject objects[] = {{.hierarchy = &scene}};
  AutoRefiner refiner = refiner_of(objects);
  for (const std::size_t extra : {0U, 1U, 100U, 3'000U, 10U, 100'000U}) {
    const std::size_t budget = refiner.base_triangles() + extra;
    EXPECT_LE(refiner.refine(before_wall(), budget_of(budget)).stats.triangles, budget);
  }
  EXPECT_THROW((void)refiner.refine(before_wall(), budget_of(refiner.base_triangles() - 1)), Error);
}

TEST(AutoRefiner, RefusesOptionsOutOfRange) {
  const Hierarchy ground = open_ground();
  const RefineObject objects[] = {{.hierarchy = &ground}};
  AutoRefiner refiner = refiner_of(objects);
  expect_all_refused([&](const RefineOptions& options) { (void)refiner.refine(above_ground(), options); });
  expect_all_refused([&](const RefineOptions& options) { (void)refiner.update(above_ground(), options); });
}

TEST(AutoRefiner, WantsACalibrationOfPositiveNumbersAndBackendsThatAreThere) {
  const Hierarchy ground = open_ground();
  const RefineObject objects[] = {{.hierarchy = &ground}};
  Calibration without_costs = round_calibration();
  without_costs.visit_ns = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(AutoRefiner(objects, without_costs), Error);
  std::vector<std::unique_ptr<Visibility>> missing(1);
  EXPECT_THROW(AutoRefiner(objects, round_calibration(), std::move(missing)), Error);
}

TEST(AutoRefiner, WantsAllBackendsInTheCalibration) {
  const Hierarchy ground = open_ground();
  const RefineObject objects[] = {{.hierarchy = &ground}};
  Calibration of_another = round_calibration();
  of_another.backends.front().name = "another";
  EXPECT_THROW(AutoRefiner(objects, of_another), Error);
}

}  // namespace
}  // namespace occlod::test
