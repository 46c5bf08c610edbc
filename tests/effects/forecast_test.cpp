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
  prospect.shares.visits_hidden = prospect.shares.splits_hidden = prospect.shares.stars_hidden = hidden;
  prospect.query_rate = usual_query_rate(Way::from_scratch);
  prospect.error_px = 1e6;  // all errors are seen
  return prospect;
}

// Whether asking has the best score.
bool asks(const Calibration& calibration, const Prospect& prospect) {
  const auto all = forecasts(calibration, prospect);
  return std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score() < b.score(); })
      ->backend.has_value();
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
  prospect.shares.coverage = {2.0, 1.0, 0.5};
  prospect.query_rate = 0.1;
  const auto all = forecasts(round_calibration(), prospect);
  ASSERT_EQ(all.size(), 2U);  // without and with the only backend
  EXPECT_NEAR(all[0].frame_ms, 0.9946, 1e-9);
  EXPECT_FALSE(all[0].backend);
  EXPECT_EQ(all[1].backend, 0U);
  EXPECT_NEAR(all[1].occlusion_ms, 0.39236, 1e-9);
}

// The coarse mesh covers half of each pixel, that of the budget eight times as much; occluders in between are in
// between, by doublings. So are those of the budget in front of a view that is covered once: dearer.
TEST(Forecast, PricesOccludersByWhatTheyCover) {
  Prospect thin = prospect_of(0.5), thick = thin;
  thin.coarse_layers = thick.coarse_layers = 0.5;
  thick.shares.coverage = {8.0, 4.0, 1.0};
  thin.shares.coverage = {1.0, 0.5, 1.0};
  const auto of_thin = forecasts(round_calibration(), thin), of_thick = forecasts(round_calibration(), thick);
  const double layer_ms = 1e-6 * 320.0 * 240.0 * 0.8;
  EXPECT_GT(of_thick[1].occlusion_ms - of_thin[1].occlusion_ms, 2.0 * layer_ms);
}

// What is hidden leaves four times the triangles for the rest. Where the rest has twice as many splits for each halving
// of the error that makes a quarter of the error; where it has four times as many, a half; where there are no more at
// all, all of them are applied and the error ends at the least that is claimed.
TEST(Forecast, FollowsHowTheErrorsOfWhatIsVisibleFall) {
  EXPECT_NEAR(error_with(0.75, 2.0), 0.25, 1e-12);
  EXPECT_NEAR(error_with(0.75, 4.0), 0.5, 1e-12);
  EXPECT_NEAR(error_with(0.75, 1.0), 0.05, 1e-12);
  EXPECT_EQ(error_with(0.0, 1.0), 1.0);
  for (const double growth : {2.0, 4.0})
    for (const double hidden : {0.1, 0.5, 0.9})
      EXPECT_NEAR(triangles_for(error_with(hidden, growth), growth), 1.0 / (1.0 - hidden), 1e-9);
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
  EXPECT_FALSE(asks(calibration, prospect_of(0.0)));
  EXPECT_TRUE(asks(calibration, prospect_of(0.9)));
  calibration.backends.front().query_ns = 1e5;
  EXPECT_FALSE(asks(calibration, prospect_of(0.9)));
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
  const EffectForecast chosen = forecasts(round_calibration(), prospect)[1];
  ASSERT_TRUE(chosen.backend);
  EXPECT_NEAR(chosen.error, 0.1, 1e-9);
  const FrameForecast same = same_error_without(round_calibration(), prospect, chosen, 1'000'000);
  EXPECT_NEAR(same.triangles, 100'000.0, 1e-3);
  EXPECT_NEAR(same.ms, 5.15 * 10.0 + 0.1536, 1e-6);
  EXPECT_NEAR(same_error_without(round_calibration(), prospect, chosen, 15'000).triangles, 15'000.0, 1e-9);
  EXPECT_NEAR(same_error_without(round_calibration(), prospect, chosen, 15'000).ms, 5.15 * 1.5 + 0.1536, 1e-9);
}

// Without queries the comparison is the frame itself.
TEST(Forecast, SavesNothingWhereNothingIsAsked) {
  const Prospect prospect = prospect_of(0.9);
  const EffectForecast none = forecasts(round_calibration(), prospect)[0];
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
  EXPECT_DOUBLE_EQ(splits_freed(region, 2.0, 2.0), 11.0);
  EXPECT_DOUBLE_EQ(splits_freed(region, 2.0, 4.0), 67.0);
  region.hidden = region.hidden_stars;
  region.hidden_subtrees_px = 0.0F;
  EXPECT_DOUBLE_EQ(splits_freed(region, 2.0, 4.0), 3.0);
}

}  // namespace
}  // namespace occlod::test
