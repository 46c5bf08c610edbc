#include "refine/forecast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "effect_scenes.h"

namespace occlod::test {
namespace {

Prospect prospect_of(double hidden) {
  Prospect prospect;
  prospect.counts = {10'000.0, 5'000.0, 0.0, 16'000.0, 320.0 * 240.0, 0.0, 2.0};
  prospect.ahead.visits_hidden = prospect.ahead.splits_hidden = prospect.ahead.stars_hidden = hidden;
  prospect.back = prospect.ahead;
  prospect.rates = usual_query_rates(Way::from_scratch);
  prospect.error_px = 1e6;  // all errors are seen
  return prospect;
}

OcclusionEffort best_of(const Calibration& calibration, const Prospect& prospect) {
  const auto all = forecasts(calibration, prospect);
  return std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score() < b.score(); })
      ->effort;
}

TEST(OcclusionEffort, HasTheNamesThatReportsUse) {
  EXPECT_EQ(name_of(OcclusionEffort::none), "none");
  EXPECT_EQ(name_of(OcclusionEffort::subtrees), "subtrees");
  EXPECT_EQ(name_of(OcclusionEffort::renewed_subtrees), "renewed-subtrees");
  EXPECT_EQ(name_of(OcclusionEffort::stars), "stars");
  EXPECT_EQ(name_of(OcclusionEffort::renewed_stars), "renewed-stars");
}

// 16,000 visits at 150 + 25 ns, 5,000 splits at 350 ns, 10,000 triangles at 60 ns and two fragments for each of 76,800
// pixels at 1 ns: 2.8 + 1.75 + 0.6 + 0.1536 ms.
TEST(Forecast, AddsUpWhatAFrameTakes) {
  EXPECT_NEAR(frame_ms_without(round_calibration(), prospect_of(0.0).counts), 5.3036, 1e-9);
}

// A frame that goes on: 120 visits, 200 splits and merges, 5,000 splits that it has at 30 ns, and the same drawing:
// 0.021 + 0.07 + 0.15 + 0.6 + 0.1536 ms. Each frame draws one occluder, of the half of 10,000 triangles that face the
// eye at 20 ns, which cover the 76,800 pixels once at 0.8 ns; and the pixels at 0.4 ns, with an answer that is waited
// for: 0.1 + 0.06144 + 0.03072 + 0.0002 ms. It asks 1,000 questions at 200 ns: 0.2 ms.
TEST(Forecast, AddsUpWhatAFrameThatGoesOnTakes) {
  Prospect prospect = prospect_of(0.0);
  prospect.way = Way::going_on;
  prospect.counts = {10'000.0, 200.0, 5'000.0, 120.0, 320.0 * 240.0, 0.0, 2.0};
  prospect.back.coverage = {2.0, 1.0, 0.5};
  prospect.rates = {0.0, 0.0, 0.0, 0.0, 0.1};
  const auto all = forecasts(round_calibration(), prospect);
  ASSERT_EQ(all.size(), 3U);  // none, subtrees, and stars too; each frame draws the occluder anew
  EXPECT_NEAR(all[0].frame_ms, 0.9946, 1e-9);
  EXPECT_EQ(all[1].effort, OcclusionEffort::renewed_subtrees);
  EXPECT_NEAR(all[1].occlusion_ms, 0.19236, 1e-9);
  EXPECT_EQ(all[2].effort, OcclusionEffort::renewed_stars);
  EXPECT_NEAR(all[2].occlusion_ms, 0.39236, 1e-9);
}

// From frame to frame, queries about stars find again what becomes hidden; where they are many, those about subtrees
// alone are the better choice, with any backend.
TEST(Forecast, FramesMayAskAboutSubtreesAlone) {
  Prospect prospect = prospect_of(0.6);
  prospect.way = Way::going_on;
  prospect.counts = {10'000.0, 200.0, 5'000.0, 120.0, 320.0 * 240.0, 0.0, 2.0};
  prospect.rates = usual_query_rates(Way::going_on);
  Calibration calibration = round_calibration();
  EXPECT_EQ(best_of(calibration, prospect), OcclusionEffort::renewed_stars);
  prospect.rates = {0.0, 0.0, 0.01, 0.0, 0.6};
  EXPECT_EQ(best_of(calibration, prospect), OcclusionEffort::renewed_subtrees);
  calibration.backends.push_back({"another", 20.0, 0.8, 0.4, 150.0, 200.0});
  const auto all = forecasts(calibration, prospect);
  ASSERT_EQ(all.size(), 5U);
  const auto best =
      std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score() < b.score(); });
  EXPECT_EQ(best->backend, 1U);
}

// The coarse mesh covers half of each pixel, that of the budget eight times as much; occluders in between are in
// between, by doublings. So are those of the budget in front of a view that is covered once: dearer.
TEST(Forecast, PricesOccludersByWhatTheyCover) {
  Prospect thin = prospect_of(0.5), thick = thin;
  thick.ahead.coverage = {1.0, 0.5, 1.0};
  thick.back.coverage = {8.0, 4.0, 1.0};
  thin.ahead.coverage = thin.back.coverage = {1.0, 0.5, 1.0};
  const auto of_thin = forecasts(round_calibration(), thin), of_thick = forecasts(round_calibration(), thick);
  for (std::size_t i = 1; i < of_thin.size(); ++i) EXPECT_GT(of_thick[i].occlusion_ms, of_thin[i].occlusion_ms) << i;
  // Four layers of the renewed occluders at most, one layer of the single one at most.
  const double layer_ms = 1e-6 * 320.0 * 240.0 * 0.8;
  EXPECT_LT(of_thick[1].occlusion_ms - of_thin[1].occlusion_ms, 1.5 * layer_ms);
  EXPECT_GT(of_thick[2].occlusion_ms - of_thin[2].occlusion_ms, 2.0 * layer_ms);
}

// What is hidden leaves four times the triangles for the rest. Where the rest has twice as many splits for each halving
// of the error that makes a quarter of the error; where it has four times as many, a half; where there are no more than
// twice as many at all, all of them are applied and the error ends at the least that is claimed.
TEST(Forecast, FollowsHowTheErrorsOfWhatIsVisibleFall) {
  const FinerCounts doubling{1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0};
  const FinerCounts fourfold{1.0, 4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0, 16384.0, 65536.0};
  const FinerCounts ending{1.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0};
  EXPECT_NEAR(error_with(0.75, doubling), 0.25, 1e-12);
  EXPECT_NEAR(error_with(0.75, fourfold), 0.5, 1e-12);
  EXPECT_NEAR(error_with(0.5, ending), 0.5, 1e-12);
  EXPECT_NEAR(error_with(0.75, ending), 0.05, 1e-12);
  EXPECT_EQ(error_with(0.0, ending), 1.0);
  for (const FinerCounts& finer : {doubling, fourfold})
    for (const double hidden : {0.1, 0.3, 0.75})
      EXPECT_NEAR(triangles_for(error_with(hidden, finer), finer), 1.0 / (1.0 - hidden), 1e-9);
}

// A picture that is as good as exact anyway gains nothing, whatever is hidden.
TEST(Forecast, ErrorsThatNobodySeesAreNoGain) {
  Prospect prospect = prospect_of(0.9);
  EXPECT_LT(forecasts(round_calibration(), prospect)[1].error, 0.5);
  prospect.error_px = 0.01;
  EXPECT_GT(forecasts(round_calibration(), prospect)[1].error, 0.99);
  EXPECT_EQ(picture_error_px(3.0, 1.0), 0.0);
}

// Where nothing is hidden occlusion saves nothing and costs something, on any machine; where nearly all is, it pays
// unless a question costs more than everything else.
TEST(Forecast, WeighsWhatIsHidden) {
  Calibration calibration = round_calibration();
  EXPECT_EQ(best_of(calibration, prospect_of(0.0)), OcclusionEffort::none);
  EXPECT_NE(best_of(calibration, prospect_of(0.9)), OcclusionEffort::none);
  calibration.backends.front().query_ns = 1e5;
  EXPECT_EQ(best_of(calibration, prospect_of(0.9)), OcclusionEffort::none);
}

// Of two backends that find the same the cheaper one is taken.
TEST(Forecast, TakesTheCheaperBackend) {
  Calibration calibration = round_calibration();
  calibration.backends.insert(calibration.backends.begin(), {"dear", 200.0, 8.0, 4.0, 2000.0, 2000.0});
  const auto all = forecasts(calibration, prospect_of(0.9));
  const auto best =
      std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score() < b.score(); });
  ASSERT_TRUE(best->backend);
  EXPECT_EQ(*best->backend, 1U);
}

// Where 90 % are hidden the error at the same budget is a tenth on a mesh whose errors fall with one over the number of
// its splits, so that without occlusion the same error takes ten times the triangles; the 5.15 ms of
// AddsUpWhatAFrameTakes that are not for pixels grow by as much. No frame is larger than that of the full mesh.
TEST(Forecast, ComparesWithAFrameOfTheSameErrorWithoutOcclusion) {
  const Prospect prospect = prospect_of(0.9);
  const EffortForecast chosen = forecasts(round_calibration(), prospect)[1];
  ASSERT_EQ(chosen.effort, OcclusionEffort::subtrees);
  EXPECT_NEAR(chosen.error, 0.1, 1e-9);
  const FrameForecast same = same_error_without(round_calibration(), prospect, chosen, 1'000'000);
  EXPECT_NEAR(same.triangles, 100'000.0, 1e-3);
  EXPECT_NEAR(same.ms, 5.15 * 10.0 + 0.1536, 1e-6);
  EXPECT_NEAR(same_error_without(round_calibration(), prospect, chosen, 15'000).triangles, 15'000.0, 1e-9);
  EXPECT_NEAR(same_error_without(round_calibration(), prospect, chosen, 15'000).ms, 5.15 * 1.5 + 0.1536, 1e-9);
}

// With effort none the comparison is the frame itself.
TEST(Forecast, SavesNothingWhereNothingIsAsked) {
  const Prospect prospect = prospect_of(0.9);
  const EffortForecast none = forecasts(round_calibration(), prospect)[0];
  const FrameForecast same = same_error_without(round_calibration(), prospect, none, 1'000'000);
  EXPECT_EQ(same.triangles, 10'000.0);
  EXPECT_EQ(same.ms, none.frame_ms);
}

// A hidden star is one split; a subtree whose error is eight times that at the end has about eight below it where
// splits become twice as many for each halving of the error, and 64 where they become four times as many.
TEST(Forecast, CountsWhatHiddenAnswersFree) {
  ObjectEffectStats::Region region;
  region.queries = 10;
  region.hidden = 4;
  region.hidden_stars = 3;
  region.hidden_subtrees_px = 16.0F;
  EXPECT_DOUBLE_EQ(splits_freed(region, 2.0, {1.0, 2.0}), 11.0);
  EXPECT_DOUBLE_EQ(splits_freed(region, 2.0, {1.0, 4.0}), 67.0);
  region.hidden = region.hidden_stars;
  region.hidden_subtrees_px = 0.0F;
  EXPECT_DOUBLE_EQ(splits_freed(region, 2.0, {1.0, 4.0}), 3.0);
}

}  // namespace
}  // namespace occlod::test
