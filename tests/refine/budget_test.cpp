#include <gtest/gtest.h>

#include <array>
#include <glm/ext/matrix_transform.hpp>

#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "refine/refine_support.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

TEST(Budget, IsNeverExceededAndNearlyUsedUpAtAnySize) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(3, 1));
  std::array<RefineObject, 1> objects{{{&hierarchy, glm::dmat4(1.0), true}}};  // two-sided: everything is worth a split
  Refiner refiner(objects);
  NoOcclusion none;
  for (const Culling culling : {Culling::subtree, Culling::star})
    for (std::size_t budget = refiner.base_triangles(); budget <= refiner.full_triangles() + 2; ++budget) {
      RefineOptions options;
      options.budget = budget;
      tune(options).culling = culling;
      const Refinement& result = refiner.refine(View(test::front_camera()), options, none);
      ASSERT_LE(result.stats.triangles, budget);
      ASSERT_EQ(result.stats.triangles, result.objects[0].triangles.size());
      // Splits of a closed surface come with two triangles each, so at most one is left over until nothing is left to
      // split.
      ASSERT_GE(result.stats.triangles + 1, std::min(budget, refiner.full_triangles()));
    }
}

TEST(Budget, FullBudgetGivesTheInput) {
  const TriangleMesh mesh = test::noisy_sphere(4, 1);
  const Hierarchy hierarchy = build_hierarchy(mesh);
  std::array<RefineObject, 1> objects{{{&hierarchy, glm::dmat4(1.0), true}}};
  Refiner refiner(objects);
  NoOcclusion none;
  RefineOptions options;
  options.budget = mesh.triangle_count();
  const Refinement& result = refiner.refine(View(test::front_camera()), options, none);
  EXPECT_EQ(result.stats.splits, hierarchy.split_count());
  EXPECT_EQ(result.objects[0].triangles, triangles_of(hierarchy, full_cut(hierarchy)));  // `restores` is tested of it
  EXPECT_EQ(result.objects[0].triangles.size(), mesh.triangle_count());
  EXPECT_EQ(result.stats.max_error_px, 0.0);
}

TEST(Budget, SmallerThanTheBaseIsRefused) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(3, 1));
  std::array<RefineObject, 1> objects{{{&hierarchy, glm::dmat4(1.0), false}}};
  Refiner refiner(objects);
  NoOcclusion none;
  RefineOptions options;
  options.budget = refiner.base_triangles() - 1;
  EXPECT_THROW((void)refiner.refine(View(test::front_camera()), options, none), Error);
  options.budget = refiner.base_triangles();
  EXPECT_EQ(refiner.refine(View(test::front_camera()), options, none).stats.splits, 0U);
}

TEST(Budget, IsSharedBySeveralObjects) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(4, 1));
  std::array<RefineObject, 2> objects{{{&hierarchy, glm::translate(glm::dmat4(1.0), {-1.2, 0, 0}), false},
                                       {&hierarchy, glm::translate(glm::dmat4(1.0), {1.2, 0, -20}), false}}};
  Refiner refiner(objects);
  NoOcclusion none;
  RefineOptions options;
  options.budget = 1500;
  const Refinement& result = refiner.refine(View(test::front_camera()), options, none);
  EXPECT_EQ(result.objects[0].triangles.size() + result.objects[1].triangles.size(), result.stats.triangles);
  EXPECT_LE(result.stats.triangles, options.budget);
  // The same surface at six times the distance is six times smaller on screen: the near one gets more.
  EXPECT_GT(result.objects[0].triangles.size(), 2 * result.objects[1].triangles.size());
  for (const RefinedObject& object : result.objects) test::expect_valid_cut(hierarchy, object);
}

TEST(Refiner, ResultsDoNotDependOnWhatCameBefore) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(4, 1));
  std::array<RefineObject, 1> objects{{{&hierarchy, glm::dmat4(1.0), false}}};
  NoOcclusion none;
  RefineOptions options;
  options.budget = 700;
  Refiner fresh(objects);
  const std::uint64_t expected = fresh.refine(View(test::front_camera(3.0)), options, none).hash();
  Refiner used(objects);
  const std::uint64_t other = used.refine(View(test::front_camera(1.5)), options, none).hash();
  EXPECT_NE(other, expected);
  EXPECT_EQ(used.refine(View(test::front_camera(3.0)), options, none).hash(), expected);
}

TEST(Refiner, GivesAResultAwayWithItsMemoryAndGoesOnAsBefore) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(4, 1));
  std::array<RefineObject, 1> objects{{{&hierarchy, glm::dmat4(1.0), false}}};
  NoOcclusion none;
  RefineOptions options;
  options.budget = 700;
  Refiner giving(objects), keeping(objects);
  for (const double distance : {3.0, 2.9, 2.8, 2.7}) {
    const View view(test::front_camera(distance));
    const Refinement& result = giving.update(view, options, none);
    const Triangle* const place = result.objects[0].triangles.data();
    const std::uint64_t hash = result.hash();
    const Refinement taken = giving.take_result();
    EXPECT_EQ(taken.objects[0].triangles.data(), place);
    EXPECT_EQ(taken.hash(), hash);
    EXPECT_EQ(result.hash(), hash);  // a copy
    EXPECT_NE(result.objects[0].triangles.data(), place);
    // What goes on from here has lost nothing.
    EXPECT_EQ(keeping.update(view, options, none).hash(), hash);
  }
}

TEST(Refiner, NeedsAHierarchy) {
  std::array<RefineObject, 1> objects{};
  EXPECT_THROW(Refiner{objects}, Error);
}

TEST(Budget, ShrinksWithTheEyeInsideAllBounds) {
  // What the eye is inside of has no limit to its size on the screen: everything is worth infinitely much, and has to
  // be given up all the same when the budget asks for it.
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(4, 1));
  for (const Culling culling : {Culling::subtree, Culling::star}) {
    Refiner refiner(std::vector<RefineObject>{{&hierarchy, glm::dmat4(1.0), true}});
    Camera camera = test::front_camera();
    camera.eye = {0.1, 0.0, 0.0};
    camera.target = {1.0, 0.0, 0.0};
    RefineOptions options;
    tune(options).culling = culling;
    NoOcclusion none;
    for (const std::size_t more : {1000U, 500U, 20U, 1U}) {
      options.budget = refiner.base_triangles() + more;
      EXPECT_LE(refiner.update(View(camera), options, none).objects[0].triangles.size(), options.budget);
    }
  }
}

}  // namespace
}  // namespace occlod
