#include <gtest/gtest.h>

#include "occlod/base.h"
#include "refine/occlusion_queries.h"
#include "refine/refine_support.h"
#include "refine/tuning.h"

namespace occlod::test {
namespace {

// Hides nothing and counts what it is asked about each object.
class CountingVisibility final : public Visibility {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "counting"; }
  void begin_view(const View& /*view*/, std::span<const ObjectView> objects) override {
    queries.assign(objects.size(), 0);
    stars = 0;
  }
  void draw_occluder(std::span<const OccluderPart> /*parts*/) override {}
  void submit(const VisibilityQuery& query) override {
    ++queries[query.object];
    if (std::holds_alternative<PointHull>(query.shape)) ++stars;
  }
  [[nodiscard]] std::uint32_t collect() override { return 1; }

  std::vector<int> queries;
  int stars = 0;
};

struct TwoSpheres {
  Hierarchy hierarchy = build_hierarchy(noisy_sphere(4, 1));
  std::vector<RefineObject> objects = {{.hierarchy = &hierarchy}, {.hierarchy = &hierarchy}};
  Refiner refiner{objects};
  CountingVisibility visibility;
  View view{front_camera()};

  const Refinement& refine(const std::vector<ObjectEffects>& effects, bool ask_stars = true) {
    RefineOptions options{.budget = 2'000, .effects = effects};
    tune(options).ask_stars = ask_stars;
    return refiner.refine(view, options, visibility);
  }
};

// A unit cube in 4 x 4 x 4 cells, x fastest; what is outside counts to the cell next to it.
TEST(EffectGate, RegionsAreCellsOfTheBox) {
  const RegionGrid grid(Box{{0.0F, 0.0F, 0.0F}, {1.0F, 1.0F, 1.0F}});
  EXPECT_EQ(grid.region_of({0.1F, 0.1F, 0.1F}), 0U);
  EXPECT_EQ(grid.region_of({0.9F, 0.1F, 0.1F}), 3U);
  EXPECT_EQ(grid.region_of({0.1F, 0.3F, 0.1F}), 4U);
  EXPECT_EQ(grid.region_of({0.1F, 0.1F, 0.6F}), 32U);
  EXPECT_EQ(grid.region_of({2.0F, 2.0F, 2.0F}), 63U);
  EXPECT_EQ(grid.region_of({-2.0F, -2.0F, -2.0F}), 0U);
  const RegionGrid flat(Box{{0.0F, 0.0F, 0.0F}, {1.0F, 1.0F, 0.0F}});
  EXPECT_EQ(flat.region_of({0.9F, 0.9F, 0.0F}), 15U);
}

TEST(EffectGate, AsksOnlyAboutObjectsThatAreOn) {
  TwoSpheres scene;
  (void)scene.refine({});
  EXPECT_GT(scene.visibility.queries[0], 0);
  EXPECT_GT(scene.visibility.queries[1], 0);
  (void)scene.refine({{}, {.occlusion = false}});
  EXPECT_GT(scene.visibility.queries[0], 0);
  EXPECT_EQ(scene.visibility.queries[1], 0);
}

// The stats say in which region each question was; one that is off has none.
TEST(EffectGate, AsksOnlyInRegionsThatAreOn) {
  TwoSpheres scene;
  const std::vector<ObjectEffectStats> all = scene.refine({}).effects;
  std::size_t used = effect_region_count;
  for (std::size_t r = 0; r < effect_region_count; ++r)
    if (all[0].regions[r].queries > 0) used = r;
  ASSERT_LT(used, effect_region_count);
  const std::uint64_t others = all_effect_regions & ~(std::uint64_t{1} << used);
  const std::vector<ObjectEffectStats> some = scene.refine({{.regions = others}, {}}).effects;
  EXPECT_EQ(some[0].regions[used].queries, 0U);
  EXPECT_GT(some[1].regions[used].queries, 0U);
}

TEST(EffectGate, AsksAboutStarsOnlyIfTold) {
  TwoSpheres scene;
  (void)scene.refine({});
  EXPECT_GT(scene.visibility.stars, 0);
  (void)scene.refine({}, false);
  EXPECT_EQ(scene.visibility.stars, 0);
  EXPECT_GT(scene.visibility.queries[0], 0);
}

// Without cones nothing is tested, and more nodes are looked at: those below what would have been dropped.
TEST(EffectGate, TestsConesOnlyIfTold) {
  TwoSpheres scene;
  const Refinement& with = scene.refine({});
  EXPECT_GT(with.effects[0].cone_culled, 0U);
  const std::size_t visits = with.stats.visits;
  const Refinement& without = scene.refine({{.cones = false}, {.cones = false}});
  EXPECT_EQ(without.effects[0].cone_tests, 0U);
  EXPECT_GT(without.stats.visits, visits);
}

TEST(EffectGate, WantsOneForEachObject) {
  TwoSpheres scene;
  EXPECT_THROW((void)scene.refine({{}}), Error);
}

}  // namespace
}  // namespace occlod::test
