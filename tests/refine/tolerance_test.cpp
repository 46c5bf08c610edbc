#include <gtest/gtest.h>

#include <array>

#include "refine/refine_support.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

class Tolerance : public ::testing::TestWithParam<Culling> {};

TEST_P(Tolerance, IsKeptWithTheFewestTrianglesThatTheLoopFinds) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(5, 1));
  std::array<RefineObject, 1> objects{{{&hierarchy, glm::dmat4(1.0), true}}};
  Refiner refiner(objects);
  NoOcclusion none;
  std::size_t last = 0;
  for (const double tolerance : {64.0, 16.0, 4.0, 1.0}) {
    RefineOptions options;
    options.budget = refiner.full_triangles();
    options.tolerance_px = tolerance;
    tune(options).culling = GetParam();
    const Refinement& result = refiner.refine(View(test::front_camera()), options, none);
    EXPECT_LE(result.stats.max_error_px, tolerance);
    EXPECT_GT(result.stats.max_error_px, 0.0);
    EXPECT_LT(result.stats.triangles, refiner.full_triangles());
    EXPECT_GT(result.stats.triangles, last);
    last = result.stats.triangles;
    // By definition: every split in sight that is not applied promises no more than the tolerance at its own star, of
    // which the node's sphere is a bound from which the nearest point can only be nearer.
    const std::vector<bool> applied = test::applied_bits(hierarchy, result.objects[0]);
    const ObjectView view(View(test::front_camera()), glm::dmat4(1.0));
    if (GetParam() == Culling::subtree)
      for (const SplitId s : hierarchy.data().roots)
        if (!applied[s]) {
          EXPECT_LE(hierarchy.node(s).guaranteed_error * view.largest_scale_px(hierarchy.node(s).sphere), tolerance);
        }
  }
}

INSTANTIATE_TEST_SUITE_P(BothCullings, Tolerance, ::testing::Values(Culling::subtree, Culling::star),
                         [](const auto& instance) { return instance.param == Culling::star ? "star" : "subtree"; });

TEST(MaxError, IsTheLargestOfWhatIsLeftWhenTheBudgetEnds) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(5, 1));
  std::array<RefineObject, 1> objects{{{&hierarchy, glm::dmat4(1.0), true}}};
  Refiner refiner(objects);
  NoOcclusion none;
  RefineOptions options;
  tune(options).culling = Culling::subtree;
  options.budget = 1000;
  const Refinement& result = refiner.refine(View(test::front_camera()), options, none);
  // The front of the refinement: splits that are not applied though their forest parent is (or that are roots).
  // Everything below has smaller errors.
  const std::vector<bool> applied = test::applied_bits(hierarchy, result.objects[0]);
  const ObjectView view(View(test::front_camera()), glm::dmat4(1.0));
  float largest = 0.0F;
  const auto look = [&](SplitId s) {
    if (s != no_id && !applied[s])
      largest = std::max(largest, hierarchy.node(s).guaranteed_error * view.largest_scale_px(hierarchy.node(s).sphere));
  };
  for (const SplitId root : hierarchy.data().roots) look(root);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    if (!applied[s]) continue;
    look(hierarchy.node(s).child_u);
    look(hierarchy.node(s).child_v);
  }
  EXPECT_FLOAT_EQ(static_cast<float>(result.stats.max_error_px), largest);
}

}  // namespace
}  // namespace occlod
