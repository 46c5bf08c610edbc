// What a frame tells of its nodes: how they came to be drawn, and what came of asking about them.
#include <gtest/gtest.h>

#include <array>
#include <set>
#include <string>

#include "occlod/device.h"
#include "occlod/device_costs.h"
#include "papers/trial_devices.h"
#include "support/hand_made_hlod.h"
#include "support/scripted_device.h"
#include "traverse/small_scenes.h"

namespace occlod::hlod {
namespace {

using occlod::test::ScriptedDevice;

Camera camera() {
  Camera camera;
  camera.eye = {-2.0, 0.0, 10.0};
  camera.target = {-2.0, 0.0, 0.0};
  camera.fov_y_deg = 90.0;
  camera.width = camera.height = 100;
  return camera;
}

std::string name_of(Answer answer) {
  constexpr std::array names = {"unread", "hidden", "visible", "wasted"};
  return names[static_cast<std::size_t>(answer)];
}

// "0 visible, 1 wasted".
std::string asked(const Frame& frame) {
  std::string text;
  for (const NodeAnswer& n : frame.asked)
    text += (text.empty() ? "" : ", ") + std::to_string(n.node) + " " + name_of(n.answer);
  return text;
}

// "3 asked, 4 asked delayed".
std::string drawn(const Frame& frame) {
  std::string text;
  for (const DrawnNode& n : frame.draws)
    text += (text.empty() ? "" : ", ") + std::to_string(n.node) + (n.asked ? " asked" : "") +
            (n.delayed ? " delayed" : "") + (n.blocked ? " blocked" : "") + (n.refined ? " refined" : "");
  return text;
}

class Told : public testing::Test {
 protected:
  const Frame& next(TrialTraverser& traverser, TrialStrategy strategy) {
    TrialOptions options;
    options.strategy = strategy;
    options.coherence = Coherence::published;  // whose stories are short
    return traverser.draw_frame(View(camera()), device_, options);
  }
  ScriptedDevice device_;
};

// Two rows of three panels, nodes 1 and 2 over 3 to 5 and 6 to 8. The second row is hidden from frame 1 on.
TEST_F(Told, WhatTheFirstFramesOfCoherentRefinementDo) {
  const Hlod rows = occlod::test::two_rows();
  const PlacedHlod placed[] = {{&rows}};
  TrialTraverser traverser(placed);
  for (const NodeId n : {2U, 6U, 7U, 8U}) device_.answer(1, n, 0);
  // Nothing was visible before: all wait for their answers, and each answer decides something.
  const Frame& first = next(traverser, TrialStrategy::coh);
  EXPECT_EQ(asked(first),
            "0 visible, 1 visible, 3 visible, 4 visible, 5 visible, 2 visible, 6 visible, 7 visible, 8 visible");
  EXPECT_EQ(drawn(first),
            "3 asked delayed, 4 asked delayed, 5 asked delayed, 6 asked delayed, 7 asked delayed, 8 asked delayed");
  // All are predicted to stop. The first row is seen, as predicted: wasted.
  const Frame& second = next(traverser, TrialStrategy::coh);
  EXPECT_EQ(asked(second), "3 wasted, 4 wasted, 5 wasted, 6 hidden, 7 hidden, 8 hidden");
  EXPECT_EQ(drawn(second), "3 asked, 4 asked, 5 asked, 6 asked, 7 asked, 8 asked");
  // The second row is asked about as one.
  const Frame& third = next(traverser, TrialStrategy::coh);
  EXPECT_EQ(asked(third), "3 wasted, 4 wasted, 5 wasted, 2 hidden");
  EXPECT_EQ(drawn(third), "3 asked, 4 asked, 5 asked");
  // Nobody asks.
  const Frame& unasked = next(traverser, TrialStrategy::vfc);
  EXPECT_EQ(asked(unasked), "");
  EXPECT_EQ(drawn(unasked), "3, 4, 5, 6, 7, 8");
}

// One pixel of node 2 is visible in frame 0, so it is drawn; in frame 1 all of it is, so what was predicted is wrong.
TEST_F(Told, ANodeThatIsRefinedAfterItWasDrawn) {
  const Hlod rows = occlod::test::two_rows();
  const PlacedHlod placed[] = {{&rows}};
  TrialTraverser traverser(placed);
  device_.answer(0, 2, 1);
  device_.answer(1, 2, 1'000'000);
  next(traverser, TrialStrategy::coh);
  const Frame& frame = next(traverser, TrialStrategy::coh);
  EXPECT_EQ(frame.stats.rarn, 1U);
  EXPECT_NE(drawn(frame).find("2 asked refined"), std::string::npos) << drawn(frame);
  EXPECT_NE(asked(frame).find("2 visible"), std::string::npos) << asked(frame);
}

// Node 2 is drawn, which denies its child 4 to be refined (stories_test.cpp).
TEST_F(Told, ANodeThatAParentBlocks) {
  const Hlod shared = occlod::test::shared_child();
  const PlacedHlod placed[] = {{&shared}};
  TrialTraverser traverser(placed);
  device_.answer(0, 2, 1);
  const Frame& frame = next(traverser, TrialStrategy::sw_b);
  EXPECT_EQ(drawn(frame), "6 asked delayed, 2 asked delayed, 4 asked delayed blocked");
}

struct Counts {
  std::size_t drawn = 0, delayed = 0, refined = 0, asked = 0, hidden = 0, wasted = 0;
};

Counts count(const Frame& frame) {
  Counts counts;
  std::set<NodeId> nodes;
  for (const DrawnNode& n : frame.draws) {
    if (!nodes.insert(n.node).second) continue;
    ++counts.drawn;
    counts.delayed += n.delayed ? 1U : 0U;
    counts.refined += n.refined ? 1U : 0U;
  }
  std::set<NodeId> asked;
  for (const NodeAnswer& n : frame.asked) {
    EXPECT_TRUE(asked.insert(n.node).second) << n.node;
    ++counts.asked;
    counts.hidden += n.answer == Answer::hidden ? 1U : 0U;
    counts.wasted += n.answer == Answer::wasted ? 1U : 0U;
  }
  for (const DrawnNode& n : frame.draws) EXPECT_EQ(n.asked, asked.contains(n.node)) << n.node;
  return counts;
}

// What is told node by node adds up to the statistics.
TEST(ToldOfACity, AddsUpToTheStatistics) {
  const Hlod& hlod = test::city(Grouping::shifted);
  const PlacedHlod placed[] = {{&hlod}};
  for (int s = 0; s <= static_cast<int>(TrialStrategy::cesium); ++s) {
    SoftwareDevice device, oracle;
    TrialTraverser traverser(placed);
    TrialOptions options;
    options.strategy = static_cast<TrialStrategy>(s);
    options.oracle = &oracle;
    options.costs = device_preset("modern");
    for (int i = 0; i < 8; ++i) {
      const Frame& frame = traverser.draw_frame(View(test::walk(hlod.data().box, i, 30)), device, options);
      const Counts counts = count(frame);
      EXPECT_EQ(counts.drawn, frame.stats.drawn_nodes) << s;
      EXPECT_EQ(counts.delayed, frame.stats.delayed) << s;
      EXPECT_EQ(counts.refined, frame.stats.rarn) << s;
      EXPECT_EQ(counts.hidden, frame.stats.hidden_nodes) << s;
      // Those ask about groups too: fewer queries than nodes, of which those that are visible are wasted.
      const bool in_groups = options.strategy == TrialStrategy::chc_plus || options.strategy == TrialStrategy::batch ||
                             options.strategy == TrialStrategy::automatic;
      EXPECT_LE(counts.wasted, frame.stats.wasted_queries) << s;
      if (!in_groups) {
        EXPECT_EQ(counts.asked, frame.stats.queries) << s;
        EXPECT_EQ(counts.wasted, frame.stats.wasted_queries) << s;
      }
    }
  }
}

}  // namespace
}  // namespace occlod::hlod
