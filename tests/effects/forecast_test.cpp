#include "effects/forecast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "effect_scenes.h"

namespace occlod::test {
namespace {

Prospect prospect_of(double hidden) {
  Prospect prospect;
  prospect.counts = {10'000.0, 5'000.0, 0.0, 16'000.0, 320.0 * 240.0};
  prospect.ahead = prospect.back = {64, 64, hidden, hidden, hidden};
  prospect.rates = usual_query_rates(Way::from_scratch);
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
// 0.021
// + 0.07 + 0.15 + 0.6 + 0.1536 ms. Each frame draws one occluder, of 10,000 triangles at 20 ns and 76,800 pixels at 0.4
// ns, with an answer that is waited for: 0.2 + 0.03072 + 0.0002 ms, and asks 1,000 questions at 200 ns: 0.2 ms.
TEST(Forecast, AddsUpWhatAFrameThatGoesOnTakes) {
  Prospect prospect = prospect_of(0.0);
  prospect.way = Way::going_on;
  prospect.counts = {10'000.0, 200.0, 5'000.0, 120.0, 320.0 * 240.0};
  prospect.rates = {0.0, 0.0, 0.0, 0.0, 0.1};
  const auto all = forecasts(round_calibration(), prospect);
  ASSERT_EQ(all.size(), 2U);  // none, and what asks again about all that is there
  EXPECT_NEAR(all[0].frame_ms, 0.9946, 1e-9);
  EXPECT_EQ(all[1].effort, OcclusionEffort::renewed_stars);
  EXPECT_NEAR(all[1].occlusion_ms, 0.43092, 1e-9);
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
  calibration.backends.insert(calibration.backends.begin(), {"dear", 200.0, 4.0, 2000.0, 2000.0});
  const auto all = forecasts(calibration, prospect_of(0.9));
  const auto best =
      std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score() < b.score(); });
  ASSERT_TRUE(best->backend);
  EXPECT_EQ(*best->backend, 1U);
}

// Where 90 % are hidden the error at the same budget is 0.1^0.4, about 0.4, on a mesh that goes on for ever. There
// error falls with one over the number of triangles, so that without occlusion the same error takes 10,000 * 0.1^-0.4
// triangles; the 5.15 ms of AddsUpWhatAFrameTakes that are not for pixels grow by as much. No frame is larger than that
// of the full mesh.
TEST(Forecast, ComparesWithAFrameOfTheSameErrorWithoutOcclusion) {
  const Prospect prospect = prospect_of(0.9);
  const EffortForecast chosen = forecasts(round_calibration(), prospect)[1];
  ASSERT_EQ(chosen.effort, OcclusionEffort::subtrees);
  const double factor = std::pow(0.1, -0.4);
  EXPECT_NEAR(chosen.error, 1.0 / factor, 1e-9);
  const FrameForecast same = same_error_without(round_calibration(), prospect, chosen, 1'000'000);
  EXPECT_NEAR(same.triangles, 10'000.0 * factor, 1e-6);
  EXPECT_NEAR(same.ms, 5.15 * factor + 0.1536, 1e-9);
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

// A hidden star is one split; a subtree whose error is eight times that at the end has about eight below it.
TEST(Forecast, CountsWhatHiddenAnswersFree) {
  ObjectEffectStats::Region region;
  region.queries = 10;
  region.hidden = 4;
  region.hidden_stars = 3;
  region.hidden_subtrees_px = 16.0F;
  EXPECT_DOUBLE_EQ(splits_freed(region, 2.0), 11.0);
}

}  // namespace
}  // namespace occlod::test
