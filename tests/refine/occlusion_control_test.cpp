// How refinement uses a backend, seen through one whose answers the test decides.
#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <functional>
#include <glm/ext/matrix_transform.hpp>

#include "refine/refine_support.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

// Answers by a rule and writes down what it was asked.
class ScriptedVisibility final : public Visibility {
 public:
  using Rule = std::function<bool(const VisibilityQuery&, std::size_t occluders_drawn)>;  // visible?
  explicit ScriptedVisibility(Rule rule, std::size_t flight = 1) : rule_(std::move(rule)), flight_(flight) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "scripted"; }
  [[nodiscard]] std::size_t flight() const noexcept override { return flight_; }
  void begin_view(const View& /*view*/, std::span<const ObjectView> objects) override {
    views = objects.size();
    answers_.clear();
    occluders.clear();
  }
  void draw_occluder(std::span<const OccluderPart> parts) override {
    EXPECT_TRUE(answers_.empty()) << "the occluder changed while questions were open";
    std::size_t triangles = 0;
    for (const OccluderPart& part : parts) triangles += part.triangles.size();
    occluders.push_back(triangles);
  }
  void submit(const VisibilityQuery& query) override {
    EXPECT_FALSE(occluders.empty()) << "asked before there was an occluder";
    answers_.push_back(rule_(query, occluders.size()));
    max_open = std::max(max_open, answers_.size());
    ++asked;
    if (const Sphere* sphere = std::get_if<Sphere>(&query.shape)) spheres.push_back(*sphere);
    if (std::holds_alternative<PointHull>(query.shape)) ++stars;
    if (std::holds_alternative<Cylinder>(query.shape)) ++cylinders;
    if (std::holds_alternative<Box>(query.shape)) ++boxes;
  }
  [[nodiscard]] std::uint32_t collect() override {
    EXPECT_FALSE(answers_.empty());
    const bool visible = answers_.front();
    answers_.pop_front();
    return visible ? 1 : 0;
  }

  [[nodiscard]] bool tests_points() const noexcept override { return object_shows != nullptr; }
  void find_visible_points(std::uint32_t object, std::span<const glm::vec3> points,
                           std::span<std::uint8_t> visible) override {
    for (std::size_t i = 0; i < points.size(); ++i) visible[i] = object_shows && object_shows(object) ? 1 : 0;
  }

  std::function<bool(std::uint32_t object)> object_shows;  // whether its points are before the occluder
  std::vector<std::size_t> occluders;                      // triangles of each occluder drawn
  std::vector<Sphere> spheres;                             // asked about
  std::size_t views = 0, asked = 0, max_open = 0, stars = 0, cylinders = 0, boxes = 0;

 private:
  Rule rule_;
  std::size_t flight_;
  std::deque<bool> answers_;
};

class OcclusionControl : public ::testing::Test {
 protected:
  OcclusionControl() : hierarchy_(build_hierarchy(test::noisy_sphere(5, 1))), objects_{{{&hierarchy_}, {&hierarchy_}}} {
    objects_[0].object_to_world = glm::translate(glm::dmat4(1.0), {-1.2, 0, 0});
    objects_[1].object_to_world = glm::translate(glm::dmat4(1.0), {1.2, 0, 0});
    options_.budget = 3000;
    tune(options_).occluder_splits = {100, 600};
  }
  const Refinement& refine(Visibility& visibility) {
    refiner_ = std::make_unique<Refiner>(objects_);
    return refiner_->refine(View(test::front_camera()), options_, visibility);
  }

  Hierarchy hierarchy_;
  std::array<RefineObject, 2> objects_;
  RefineOptions options_;
  std::unique_ptr<Refiner> refiner_;
};

TEST_F(OcclusionControl, HiddenObjectIsLeftAtTheFirstOccluder) {
  for (const Culling culling : {Culling::subtree, Culling::star})
    for (const std::size_t flight : {1U, 8U}) {
      tune(options_).culling = culling;
      tune(options_).level_step = 1;
      ScriptedVisibility second_hidden([](const VisibilityQuery& q, std::size_t) { return q.object != 1; }, flight);
      const Refinement& result = refine(second_hidden);
      // Until the first occluder both are refined alike: 100 splits and what the last one forced. After it nothing but
      // the first.
      EXPECT_LE(result.objects[1].splits.size(), 110U);
      EXPECT_GT(result.objects[0].triangles.size(), 2 * result.objects[1].triangles.size());
      EXPECT_GE(result.stats.triangles + 1, options_.budget);  // what was saved is spent
      EXPECT_GT(result.stats.culled_occlusion, 0U);
      for (const RefinedObject& object : result.objects) test::expect_valid_cut(hierarchy_, object);
    }
}

TEST_F(OcclusionControl, AllVisibleGivesTheSameAsNoOcclusion) {
  NoOcclusion none;
  const std::uint64_t expected = refine(none).hash();
  ScriptedVisibility visible([](const VisibilityQuery&, std::size_t) { return true; });
  const Refinement& result = refine(visible);
  EXPECT_EQ(result.hash(), expected);
  EXPECT_EQ(result.stats.queries, visible.asked);
  EXPECT_EQ(result.stats.queries_hidden, 0U);
}

TEST_F(OcclusionControl, OccludersAreDrawnAtTheStepsAndWhatTheyHidIsAskedAgain) {
  for (RefineObject& object : objects_) object.two_sided = true;  // so that occluders are whole cuts
  // The first occluder hides everything: refinement runs dry, having applied no more than the first step. It must not
  // end there: but the second occluder is due only after 600 splits. So let the first hide the second object only, and
  // the second nothing.
  ScriptedVisibility recovering(
      [](const VisibilityQuery& q, std::size_t occluders) { return occluders >= 2 || q.object != 1; });
  const Refinement& result = refine(recovering);
  ASSERT_EQ(recovering.occluders.size(), 2U);  // nothing was hidden at the end, so nothing had to be checked
  EXPECT_EQ(result.stats.occluder_draws, 2U);
  // Drawn when 100 (600) splits are applied; each closed-surface split has two triangles, forced ones may overshoot a
  // little.
  const std::size_t base = refiner_->base_triangles();
  EXPECT_GE(recovering.occluders[0], base + 2 * 100);
  EXPECT_LE(recovering.occluders[0], base + 2 * 120);
  EXPECT_GE(recovering.occluders[1], base + 2 * 600);
  EXPECT_LE(recovering.occluders[1], base + 2 * 620);
  EXPECT_EQ(result.stats.culled_occlusion, 0U);  // nothing stays hidden that the last occluder shows
  EXPECT_GT(result.objects[1].splits.size(), 300U);
}

// The given occluders hide the second object; the final mesh does not.
TEST_F(OcclusionControl, FinalCheckReadmitsWhatTheFinalMeshShows) {
  for (const std::size_t flight : {1U, 8U}) {
    const auto rule = [](const VisibilityQuery& q, std::size_t occluders) { return occluders >= 3 || q.object != 1; };
    tune(options_).final_check = false;
    ScriptedVisibility unchecked(rule, flight);
    const Refinement& without = refine(unchecked);
    EXPECT_EQ(without.stats.occluder_draws, 2U);
    EXPECT_LE(without.objects[1].splits.size(), 110U);
    const double max_error_px = without.stats.max_quadric_error_px;

    tune(options_).final_check = true;
    ScriptedVisibility checked(rule, flight);
    const Refinement& result = refine(checked);
    EXPECT_EQ(result.stats.occluder_draws, 3U);
    EXPECT_GT(result.stats.readmitted, 0U);
    EXPECT_GT(result.stats.taken_back, 0U);  // the budget had been used up
    EXPECT_LE(result.stats.triangles, options_.budget);
    EXPECT_EQ(result.stats.culled_occlusion, 0U);
    // Both objects are the same and as near: each has about half of the splits in the end.
    const auto splits = static_cast<double>(result.stats.splits);
    EXPECT_NEAR(static_cast<double>(result.objects[1].splits.size()), splits / 2, splits / 10);
    EXPECT_EQ(result.stats.splits, result.objects[0].splits.size() + result.objects[1].splits.size());
    EXPECT_GT(result.stats.max_quadric_error_px, max_error_px);  // which the other run did not know of
    for (const RefinedObject& object : result.objects) test::expect_valid_cut(hierarchy_, object);
  }
}

TEST_F(OcclusionControl, WithoutRetestHiddenStaysHiddenUntilTheFinalCheck) {
  ScriptedVisibility recovering(
      [](const VisibilityQuery& q, std::size_t occluders) { return occluders >= 2 || q.object != 1; });
  tune(options_).retest_hidden = false;
  tune(options_).final_check = false;
  const Refinement& result = refine(recovering);
  EXPECT_EQ(result.stats.occluder_draws, 2U);
  EXPECT_LE(result.objects[1].splits.size(), 110U);
  EXPECT_GT(result.stats.culled_occlusion, 0U);
}

TEST_F(OcclusionControl, SplitsThatForceUnseenOnesWait) {
  NoOcclusion none;
  tune(options_).forced_exponent = 0.0;
  const std::size_t careless = refine(none).stats.forced_unseen_splits;
  tune(options_).forced_exponent = 0.5;
  const Refinement& result = refine(none);
  EXPECT_LT(result.stats.forced_unseen_splits, careless * 3 / 4);
  EXPECT_GE(result.stats.triangles + 1, options_.budget);
  for (const RefinedObject& object : result.objects) test::expect_valid_cut(hierarchy_, object);
}

// The stars of both objects are visible, and the vertices of one are covered: its splits count a fourth, so at the same
// worth it has about a fourth of the splits, for errors fall in proportion to the area of faces.
TEST_F(OcclusionControl, CoveredVerticesYield) {
  ScriptedVisibility covered([](const VisibilityQuery&, std::size_t) { return true; });
  covered.object_shows = [](std::uint32_t object) { return object != 1; };
  const Refinement& result = refine(covered);
  EXPECT_EQ(result.stats.queries_hidden, 0U);
  const std::size_t free = result.objects[0].splits.size(), yielding = result.objects[1].splits.size();
  EXPECT_GT(6 * yielding, free);
  EXPECT_LT(2 * yielding, free);
  EXPECT_GE(result.stats.triangles + 1, options_.budget);
  tune(options_).covered_factor = 1.0;
  const std::uint64_t hash = refine(covered).hash();
  NoOcclusion none;
  EXPECT_EQ(refine(none).hash(), hash);
}

// From frame to frame splits yield as from scratch, whether they are applied or not, and come back when they show.
TEST_F(OcclusionControl, CoveredVerticesYieldFromFrameToFrame) {
  ScriptedVisibility visibility([](const VisibilityQuery&, std::size_t) { return true; });
  visibility.object_shows = [](std::uint32_t) { return true; };
  refiner_ = std::make_unique<Refiner>(objects_);
  Camera camera = test::front_camera();
  const auto splits_of_second = [&] {
    std::size_t splits = 0;
    for (int frame = 0; frame < 60; ++frame) {
      camera.eye.x += 0.001;
      splits = refiner_->update(View(camera), options_, visibility).objects[1].splits.size();
    }
    return static_cast<double>(splits);
  };
  const double shown = splits_of_second();
  visibility.object_shows = [](std::uint32_t object) { return object != 1; };
  const double covered = splits_of_second();
  Refiner scratch(objects_);
  const auto from_scratch =
      static_cast<double>(scratch.refine(View(camera), options_, visibility).objects[1].splits.size());
  EXPECT_LT(covered, 0.6 * shown);
  EXPECT_NEAR(covered, from_scratch, 0.2 * from_scratch);
  visibility.object_shows = [](std::uint32_t) { return true; };
  EXPECT_NEAR(splits_of_second(), shown, 0.1 * shown);
}

TEST_F(OcclusionControl, NoOccluderNoQuestions) {
  tune(options_).occluder_splits = {1'000'000};
  ScriptedVisibility hides_all([](const VisibilityQuery&, std::size_t) { return false; });
  EXPECT_EQ(refine(hides_all).stats.queries, 0U);
  EXPECT_EQ(hides_all.views, 2U);
}

TEST_F(OcclusionControl, SubtreesAreAskedAboutOnOddLevelsOnly) {
  tune(options_).proxy = Proxy::sphere;
  ScriptedVisibility visible([](const VisibilityQuery&, std::size_t) { return true; });
  (void)refine(visible);
  ASSERT_FALSE(visible.spheres.empty());
  // A node and its only child may have the same sphere, so: some node on an odd level has it, and no question is about
  // one that only even levels have.
  std::vector<std::uint32_t> levels(hierarchy_.split_count(), 0);
  for (SplitId s = 0; s < hierarchy_.split_count(); ++s)
    if (const SplitId parent = hierarchy_.node(s).parent; parent != no_id) levels[s] = levels[parent] + 1;
  const auto on_odd_level = [&](const Sphere& sphere) {
    for (SplitId s = 0; s < hierarchy_.split_count(); ++s) {
      const SplitNode& node = hierarchy_.node(s);
      if (levels[s] % 2 == 1 && node.sphere.center == sphere.center && node.sphere.radius == sphere.radius) return true;
    }
    return false;
  };
  EXPECT_TRUE(std::all_of(visible.spheres.begin(), visible.spheres.end(), on_odd_level));
  const std::size_t odd = visible.spheres.size();
  tune(options_).level_step = 1;
  ScriptedVisibility all_levels([](const VisibilityQuery&, std::size_t) { return true; });
  (void)refine(all_levels);
  EXPECT_GT(all_levels.spheres.size(), odd * 3 / 2);
}

TEST_F(OcclusionControl, ProxyChoosesTheShape) {
  const auto count = [&](Proxy proxy) {
    tune(options_).proxy = proxy;
    auto visible = std::make_unique<ScriptedVisibility>([](const VisibilityQuery&, std::size_t) { return true; });
    (void)refine(*visible);
    return visible;
  };
  EXPECT_GT(count(Proxy::cylinder)->cylinders, 0U);
  EXPECT_GT(count(Proxy::box)->boxes, 0U);
  EXPECT_EQ(count(Proxy::box)->cylinders, 0U);
  EXPECT_GT(count(Proxy::sphere)->spheres.size(), 0U);
  EXPECT_GT(count(Proxy::sphere)->stars, 0U);
  tune(options_).culling = Culling::subtree;
  EXPECT_EQ(count(Proxy::sphere)->stars, 0U);  // the paper asks one question
}

TEST_F(OcclusionControl, FlightsAreFilledAndNeverOverfilled) {
  for (const Culling culling : {Culling::subtree, Culling::star}) {
    tune(options_).culling = culling;
    ScriptedVisibility visible([](const VisibilityQuery&, std::size_t) { return true; }, 8);
    const Refinement& result = refine(visible);
    EXPECT_EQ(visible.max_open, 8U);
    EXPECT_GE(result.stats.triangles + 1, options_.budget);
    // The order of questions, not their answers, is what a flight changes: deterministic all the same.
    ScriptedVisibility again([](const VisibilityQuery&, std::size_t) { return true; }, 8);
    const std::uint64_t hash = result.hash();
    EXPECT_EQ(refine(again).hash(), hash);
  }
}

}  // namespace
}  // namespace occlod
