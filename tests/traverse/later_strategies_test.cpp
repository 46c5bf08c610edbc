// The exact sequence of draws and questions of the strategies that weigh what questions cost, or group them.
#include <gtest/gtest.h>

#include <array>
#include <map>

#include "hlod/draw/strategy_choice.h"
#include "occlod/base.h"
#include "occlod/device.h"
#include "papers/trial_devices.h"
#include "support/hand_made_hlod.h"
#include "support/scripted_device.h"
#include "traverse/small_scenes.h"

namespace occlod::hlod {
namespace {

using occlod::test::LoggedDevice;
using occlod::test::ScriptedDevice;

// Frames from one eye; with a tolerance of 1 px nodes 0, 1 and 2 are refined. Nodes are reached in the order 0 1 3 4 5
// 2 6 7 8 (see the stories).
class Frames {
 public:
  explicit Frames(TrialStrategy strategy) : objects_{{{&rows_}}}, traverser_(objects_), logged_(device) {
    options.strategy = strategy;
    options.biased = false;
    options.oracle = &oracle;
    options.costs = {.name = "test", .draw_ns = 1e6, .query_ns = 1e-3, .batch_ns = 1e-3, .batch_item_ns = 1e-6};
  }
  std::string next() {
    stats = traverser_.draw_frame(View(occlod::test::camera_ahead()), logged_, options).stats;
    return logged_.log();
  }

  ScriptedDevice device, oracle;
  TrialOptions options;
  FrameStats stats;

 private:
  Hlod rows_ = occlod::test::two_rows();
  std::array<PlacedHlod, 1> objects_;
  TrialTraverser traverser_;
  LoggedDevice logged_;
};

const std::string all_drawn = "draw 3, draw 4, draw 5, draw 6, draw 7, draw 8";

// A question costs more than all that it can save: as vfc.
TEST(NearOptimal, AsksNothingWhereQuestionsAreDear) {
  Frames frames(TrialStrategy::nohc);
  frames.options.costs.query_ns = 1e9;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(frames.next(), all_drawn);
  EXPECT_EQ(frames.stats.queries, 0U);
}

// Questions cost next to nothing, so every node is asked about that may be hidden: those which c_bb < c_scr holds for.
// 3 to 5 have c_bb = 2500 * 8 / 6 / (100 * 10^4) = 0.0033 (at distances 10, 10.06, 10.46), and R_cov = 3/2 * 4 / 8 =
// 0.75, so c_scr is 0.0025 after 3, 0.005 after 4: 5 is the first to be asked about. The second row's leaves have 2500
// * 2.88 / 6 / (196 * 10^4) = 0.0006. All of it is new, so nothing is waited for.
TEST(NearOptimal, AsksOnAnyLevelAndDropsWhatIsBelowAHiddenNode) {
  Frames frames(TrialStrategy::nohc);
  frames.device.answer(0, 2, 0);
  // Node 2 would be refined at once, but its answer is there before its children's turn: they are dropped.
  EXPECT_EQ(frames.next(), "draw 3, draw 4, ask 5, draw 5, get 5, ask 2, get 2");
  EXPECT_EQ(frames.stats.wasted_queries, 1U);  // about 5
  // It was hidden, so it is asked about and waited for.
  EXPECT_EQ(frames.next(), "draw 3, draw 4, ask 5, draw 5, get 5, ask 2, get 2");
  frames.device.answer(2, 2, 10'000);
  // It shows. Its children are new; they are drawn without waiting.
  EXPECT_EQ(frames.next(),
            "draw 3, draw 4, ask 5, draw 5, get 5, ask 2, get 2, ask 6, draw 6, get 6, ask 7, draw 7, get 7, ask 8, "
            "draw 8, get 8");
}

// With late answers the children of a hidden node are on their way when it turns out to be hidden.
TEST(NearOptimal, LooksAtAnswersWhenTheyMustBeThere) {
  Frames frames(TrialStrategy::nohc);
  frames.device.delay(4);
  frames.device.answer(0, 2, 0);
  // N_q = ceil((1e-3 + 0) / 1e-3) + 1 = 2: with two questions under way the first must be answered. Of 5 after ask 2;
  // of 2 after ask 6. Node 6 has been drawn by then, 7 and 8 are dropped, and nobody looks at the answer about 6.
  EXPECT_EQ(frames.next(), "draw 3, draw 4, ask 5, draw 5, ask 2, wait 5, ask 6, draw 6, wait 2");
  // What was drawn below a hidden node counts as hidden.
  EXPECT_EQ(frames.stats.drawn_nodes, 4U);
}

// Only what is hidden is asked about, and nothing is waited for; or drawn, where that is cheaper.
TEST(Optimum, AsksWhatIsHiddenAndNothingElse) {
  Frames frames(TrialStrategy::optimum);
  frames.oracle.answer(0, 2, 0);
  frames.device.delay(100);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(frames.next(), "draw 3, draw 4, draw 5, ask 2");
  EXPECT_EQ(frames.stats.hidden_nodes, 1U);
  frames.options.costs.query_ns = 4e6;  // three draws cost 3e6
  EXPECT_EQ(frames.next(), all_drawn);
  frames.options.costs.query_ns = 2e6;
  EXPECT_EQ(frames.next(), "draw 3, draw 4, draw 5, ask 2");
}

TEST(TwoPass, DrawsWhatWasVisibleAndTestsEverythingOnce) {
  Frames frames(TrialStrategy::two_pass);
  frames.device.answer(0, 2, 0);
  // Nothing was visible: the root is tested, and all of it drawn.
  EXPECT_EQ(frames.next(), "ask each 0, get 0, " + all_drawn);
  EXPECT_EQ(frames.next(), all_drawn + ", ask each 3+4+5+6+7+8, get 3+4+5+6+7+8");
  for (const NodeId n : {6U, 7U, 8U}) frames.device.answer(2, n, 0);
  frames.device.answer(3, 2, 0);
  EXPECT_EQ(frames.next(), all_drawn + ", ask each 3+4+5+6+7+8, get 3+4+5+6+7+8");
  for (int i = 0; i < 2; ++i) EXPECT_EQ(frames.next(), "draw 3, draw 4, draw 5, ask each 3+4+5+2, get 3+4+5+2");
  frames.device.answer(5, 2, 10'000);
  EXPECT_EQ(frames.next(), "draw 3, draw 4, draw 5, ask each 3+4+5+2, get 3+4+5+2, draw 6, draw 7, draw 8");
}

// One level a frame; what is hidden is drawn as it is.
TEST(Cesium, RefinesWhatWasSeenInTheLastFrame) {
  Frames frames(TrialStrategy::cesium);
  frames.device.answer(0, 2, 0);
  EXPECT_EQ(frames.next(), "ask 0, draw 0, get 0");
  EXPECT_EQ(frames.next(), "ask 0, get 0, ask 1, draw 1, get 1, ask 2, draw 2, get 2");
  for (int i = 0; i < 2; ++i)
    EXPECT_EQ(frames.next(), "ask 0, get 0, ask 1, get 1, draw 3, draw 4, draw 5, ask 2, draw 2, get 2");
  frames.device.answer(4, 2, 10'000);
  EXPECT_EQ(frames.next(), "ask 0, get 0, ask 1, get 1, draw 3, draw 4, draw 5, ask 2, draw 2, get 2");
  EXPECT_EQ(frames.next(), "ask 0, get 0, ask 1, get 1, draw 3, draw 4, draw 5, ask 2, get 2, draw 6, draw 7, draw 8");
}

// Late answers are waited for when everything is drawn, not before: refinement does not stand still where frames are
// shorter than an answer takes.
TEST(Cesium, WaitsOnlyAtTheEnd) {
  Frames frames(TrialStrategy::cesium);
  frames.device.delay(100);
  EXPECT_EQ(frames.next(), "ask 0, draw 0, wait 0");
  EXPECT_EQ(frames.next(), "ask 0, ask 1, draw 1, ask 2, draw 2, wait 0, wait 1, wait 2");
  EXPECT_EQ(frames.next(),
            "ask 0, ask 1, draw 3, draw 4, draw 5, ask 2, draw 6, draw 7, draw 8, wait 0, wait 1, wait 2");
}

// Hidden nodes are kept until nothing else is left. Siblings 6 and 7, hidden once, are asked about together:
// V = 1 / (1 + 0.27) = 0.79 of one, 2 / (1 + 0.46 * 2) = 1.04 of both (p_keep = 0.99 - 0.7 / e = 0.73).
TEST(Grouping, AsksAboutHiddenNodesTogether) {
  Frames frames(TrialStrategy::chc_plus);
  frames.device.answer(0, 6, 0);
  frames.device.answer(0, 7, 0);
  // The root's box is larger than those of its grandchildren together: it is asked about by them.
  const std::string first = frames.next();
  EXPECT_TRUE(first.starts_with("ask 3+4+5+6+7+8, get 3+4+5+6+7+8, ")) << first;
  EXPECT_EQ(frames.next(), "draw 3, draw 4, draw 5, draw 8, ask 6+7, get 6+7");
  EXPECT_EQ(frames.stats.hidden_nodes, 2U);
  // One of them shows: both are asked about by themselves.
  frames.device.answer(2, 7, 10'000);
  const std::string third = frames.next();
  EXPECT_TRUE(third.starts_with("draw 3, draw 4, draw 5, draw 8, ask 6+7, get 6+7, ask 6, ask 7, get 6, get 7, draw 7"))
      << third;
}

// Visible leaves are asked about every ten frames at least, and not all in the same.
TEST(Grouping, AsksAboutVisibleLeavesNowAndThen) {
  Frames frames(TrialStrategy::chc_plus);
  std::map<std::string, int> asked;
  std::size_t most = 0;
  frames.next();
  for (int i = 0; i < 40; ++i) {
    const std::string log = frames.next();
    for (const char* n : {"ask 3", "ask 4", "ask 5", "ask 6", "ask 7", "ask 8"})
      asked[n] += log.find(n) != std::string::npos ? 1 : 0;
    most = std::max(most, frames.stats.queries);
  }
  for (const auto& [n, times] : asked) {
    EXPECT_GE(times, 3) << n;  // 1 + 30 / 10 at least, as the first wait is up to 10
    EXPECT_LE(times, 8) << n;  // 40 / 5
  }
  EXPECT_LT(most, 6U);
}

// What is new is drawn where nothing covers it; 5 and the second row may be covered, and are asked about together.
TEST(Batch, AsksInRoundsWhereThatPays) {
  Frames frames(TrialStrategy::batch);
  frames.options.costs.query_ns = 1.0;
  frames.device.answer(0, 2, 0);
  EXPECT_EQ(frames.next(), "draw 3, draw 4, ask each 5+2, get 5+2, draw 5");
  // The first row was visible: drawn, and counted, since that costs nearly nothing. 2 was hidden.
  EXPECT_EQ(frames.next(), "draw 3, draw 4, draw 5, ask each 3+4+5+2, get 3+4+5+2");
  frames.options.costs.batch_ns = frames.options.costs.query_ns =
      1e12;  // nothing is worth that: what was to be asked counts as visible
  EXPECT_EQ(frames.next(), all_drawn);
  EXPECT_EQ(frames.stats.queries, 0U);
}

// One query costs less than a batch: what was visible is asked about when nothing else is to do.
TEST(Batch, AsksInGroupsWhereBatchesAreDear) {
  Frames frames(TrialStrategy::batch);
  frames.options.costs.batch_ns = 1.0;
  frames.device.answer(0, 2, 0);
  frames.next();
  EXPECT_EQ(frames.next(), "draw 3, draw 4, draw 5, ask 2, get 2, ask 3, get 3, ask 4, get 4, ask 5, get 5");
}

// What stays visible is asked about the seldomer the dearer a query is, and the more often the more of its kind have
// been found hidden.
TEST(Batch, AsksAboutVisibleNodesAsOftenAsTheyDisappear) {
  const auto questions = [](double query_ns, bool others_disappear) {
    Frames frames(TrialStrategy::batch);
    frames.options.costs.batch_ns = 1e12;
    frames.options.costs.query_ns = query_ns;
    std::size_t asked = 0;
    for (std::uint32_t i = 0; i < 200; ++i) {
      if (others_disappear)
        for (const NodeId n : {6U, 7U, 8U}) frames.device.answer(i, n, i % 4 < 2 ? 0 : 10'000);
      asked += frames.next().find("ask 3") != std::string::npos ? 1U : 0U;
    }
    return asked;
  };
  const std::size_t cheap = questions(1e4, false), dear = questions(1e5, false);
  EXPECT_GT(cheap, 2 * dear);
  EXPECT_GT(dear, 0U);
  EXPECT_GT(questions(1e5, true), dear);
}

TEST(Batch, HasThreeRoundsAtMost) {
  const Hlod& hlod = test::city(Grouping::shifted);
  const PlacedHlod placed{&hlod};
  SoftwareDevice device;
  struct Counting : LoggedDevice {
    using LoggedDevice::LoggedDevice;
    QueryId ask_each(std::span<const BoxRef> boxes) override {
      ++batches;
      return LoggedDevice::ask_each(boxes);
    }
    int batches = 0;
  } counting(device);
  TrialTraverser traverser({&placed, 1});
  TrialOptions options;
  options.strategy = TrialStrategy::batch;
  options.costs = device_preset("modern");
  options.costs.batch_ns = 1.0;
  options.costs.readback_ns = 0.0;
  int most = 0;
  for (int i = 0; i < 20; ++i) {
    counting.batches = 0;
    traverser.draw_frame(View(test::walk(hlod.data().box, i, 100)), counting, options);
    most = std::max(most, counting.batches);
  }
  EXPECT_GT(most, 1);
  EXPECT_LE(most, 3);
}

// batch takes 5, vfc 10: it is tried in the 16th frame, and then so seldom that it takes half a percent of the time.
TEST(Choice, TakesWhatTakesLeast) {
  const double ms[] = {5.0, 10.0};
  StrategyChoice choice;
  std::vector<std::uint32_t> trials;
  for (std::uint32_t frame = 1; frame <= 1000; ++frame) {
    const std::size_t drawn = choice.next();
    choice.note(ms[drawn]);
    if (StrategyChoice::candidates[drawn] == Strategy::vfc) trials.push_back(frame);
  }
  EXPECT_EQ(trials, (std::vector<std::uint32_t>{16, 216, 416, 616, 816}));
  std::vector<StrategyForecast> forecasts;
  choice.write_forecasts(forecasts);
  ASSERT_EQ(forecasts.size(), 2U);
  EXPECT_EQ(forecasts[0].strategy, Strategy::batch);
  EXPECT_DOUBLE_EQ(forecasts[0].frame_ms, 5.0);
  EXPECT_DOUBLE_EQ(forecasts[1].frame_ms, 10.0);
  EXPECT_EQ(forecasts[1].age, 1000U - 816U);
}

// When the chosen one has become worse than the other, that is taken, until it is worse again: after four frames, since
// batch has to learn what is hidden. That all frames take longer than they did decides nothing.
TEST(Choice, ChangesItsMind) {
  StrategyChoice choice;
  double ms[] = {5.0, 10.0};
  int frame = 0;
  const auto draw_until = [&](int last) {
    int other = 0;
    for (; frame < last; ++frame) {
      const std::size_t drawn = choice.next();
      choice.note(ms[drawn]);
      other += drawn == 1 ? 1 : 0;
    }
    return other;
  };
  EXPECT_EQ(draw_until(100), 1);
  ms[0] = 50.0, ms[1] = 100.0;
  EXPECT_EQ(draw_until(300), 1);  // in frame 216, at twice the time of its neighbours
  ms[0] = 12.0, ms[1] = 10.0;
  EXPECT_EQ(draw_until(500), 85);  // from frame 416
  ms[0] = 9.0;
  EXPECT_EQ(draw_until(700), 77);  // until frame 574, and in three trials more
}

TEST(Costs, AreNeeded) {
  for (const TrialStrategy strategy :
       {TrialStrategy::nohc, TrialStrategy::optimum, TrialStrategy::batch, TrialStrategy::automatic}) {
    Frames frames(strategy);
    frames.options.costs = {};
    EXPECT_THROW(frames.next(), Error);
    frames.options.costs = device_preset("modern");
    frames.options.costs.query_ns = -1.0;
    EXPECT_THROW(frames.next(), Error);
  }
}

// The same fronts whenever the answers are the same: choices depend on no clock.
TEST(Determinism, SavedCostsGiveTheSameFronts) {
  const Hlod& hlod = test::city(Grouping::shifted);
  const PlacedHlod placed{&hlod};
  for (const TrialStrategy strategy : test::later_strategies) {
    std::array<std::vector<std::uint64_t>, 2> hashes;
    for (auto& run : hashes) {
      SoftwareDevice device, oracle;
      TrialTraverser traverser({&placed, 1});
      TrialOptions options;
      options.strategy = strategy;
      options.oracle = &oracle;
      options.costs = device_preset("query-dear");
      for (int i = 0; i < 40; ++i)
        run.push_back(traverser.draw_frame(View(test::walk(hlod.data().box, i, 200)), device, options).front_hash);
    }
    EXPECT_EQ(hashes[0], hashes[1]) << static_cast<int>(strategy);
  }
}

}  // namespace
}  // namespace occlod::hlod
