#include "support/traversal_stories.h"

#include <gtest/gtest.h>

#include <array>
#include <glm/ext/matrix_transform.hpp>

#include "support/hand_made_hlod.h"

namespace occlod::test {

using hlod::TrialStrategy;

namespace {

// Sees the first row only. Distances of nodes: 0, 1, 3: 10; 4: 10.06; 5: 10.46; 2, 6: 14; 7: 14.07; 8: 14.4. So nodes
// are reached in the order 0 1 3 4 5 2 6 7 8. Errors: node 0: 2 * 50 / 10 = 10 px, node 1: 5 px, node 2: 3.57 px.
const Camera ahead = camera_ahead();
// Sees the second row over the first, whose shadow falls below y = -1.8 there. The order is the same: 1, 3: 12.2;
// 4: 12.25; 5: 12.57; 2: 15.8.
const Camera above = square_camera({-2.0, 8.0, 10.0}, {-2.0, 0.0, 0.0});
// Between the rows, inside the box of node 0: node 1 is behind the eye, and node 8 (1.4 to 2.6, at distance 2) outside
// of 90 degrees.
const Camera between = square_camera({-2.0, 0.0, -2.0}, {-2.0, 0.0, -10.0});

// What is left of a node behind the occluder: B is 0 within rounding.
constexpr std::uint32_t hardly_visible = 1;
constexpr std::uint32_t visible = 10'000;

// Every node is new, is asked about and waited for, whatever the strategy. The second row is hidden.
const std::string all_new =
    "ask 0, get 0, ask 1, get 1, ask 3, get 3, draw 3, ask 4, get 4, draw 4, ask 5, get 5, draw 5, ask 2, get 2";
// Nodes 0 and 1 are refined unasked, their children asked about and drawn at once.
const std::string first_row_again = "ask 3, draw 3, get 3, ask 4, draw 4, get 4, ask 5, draw 5, get 5";
const std::string second_row_again = "ask 6, draw 6, get 6, ask 7, draw 7, get 7, ask 8, draw 8, get 8";
const std::string second_row_new = "ask 2, get 2, ask 6, get 6, draw 6, ask 7, get 7, draw 7, ask 8, get 8, draw 8";

void hide_second_row(ScriptedDevice& device) { device.answer(0, 2, 0); }

// Every node is asked about in every frame, after all that is nearer has been drawn.
Story stop_and_wait(TrialStrategy strategy) {
  Story story{"everything is asked and waited for", strategy};
  story.script = [](ScriptedDevice& device) {
    hide_second_row(device);
    device.answer(2, 2, visible);
  };
  const std::string first_row =
      "ask 0, get 0, ask 1, get 1, ask 3, get 3, draw 3, ask 4, get 4, draw 4, ask 5, get 5, draw 5, ";
  story.frames = {{ahead, false, all_new}, {ahead, false, all_new}, {above, false, first_row + second_row_new}};
  return story;
}

// With a tolerance of 1 px all that is visible is refined to the leaves. The second row comes into sight and goes
// again.
Story comes_and_goes(TrialStrategy strategy) {
  Story story{"the second row comes and goes", strategy};
  story.script = [](ScriptedDevice& device) {
    hide_second_row(device);
    device.answer(2, 2, visible);
    for (const hlod::NodeId n : {2U, 6U, 7U, 8U}) device.answer(4, n, 0);
  };
  story.frames = {
      {ahead, false, all_new},
      {ahead, false, first_row_again + ", ask 2, get 2"},         // node 2 was hidden: its answer decides
      {above, false, first_row_again + ", " + second_row_new},    // it shows: children that are new, so theirs decide
      {above, false, first_row_again + ", " + second_row_again},  // node 2 was seen by its children: refined unasked
      {ahead, false, first_row_again + ", " + second_row_again},  // hidden again: three draws for nothing
      {ahead, false, first_row_again + ", ask 2, get 2"},         // no child saw anything: the front is up at node 2
      {ahead, false, first_row_again + ", ask 2, get 2"},
  };
  return story;
}

// Node 8 rises above the first row: half of it is seen; its siblings are hidden and asked about in every frame. So the
// mean bias of node 2's children is 0.21 or more, and its error 0.77 px: with a tolerance of 0.5 px it stays refined.
Story hidden_siblings(TrialStrategy strategy) {
  Story story{"siblings of a visible node are hidden", strategy, 0.5};
  story.last_rises = true;
  story.script = [](ScriptedDevice& device) {
    device.answer(0, 6, 0);
    device.answer(0, 7, 0);
  };
  const std::string second_row = "ask 6, get 6, ask 7, get 7, ask 8, ";
  story.frames = {{ahead, false, all_new + ", " + second_row + "get 8, draw 8"},
                  {ahead, false, first_row_again + ", " + second_row + "draw 8, get 8"}};
  return story;
}

// With the eye in its box a node is visible, whatever the device would say, and not asked about.
Story enters_a_node(TrialStrategy strategy) {
  Story story{"the eye goes into the box of node 0", strategy};
  story.script = [](ScriptedDevice& device) {
    hide_second_row(device);
    device.answer(1, 2, visible);
  };
  story.frames = {{ahead, false, all_new},
                  {between, false, "ask 2, get 2, ask 6, get 6, draw 6, ask 7, get 7, draw 7"},
                  {between, false, "ask 6, draw 6, get 6, ask 7, draw 7, get 7"}};
  return story;
}

// Tolerance 4.9 px, node 1 has 5. Reached in frame 0: 6 nodes, so in frame 1 node 1, the second, is predicted to be
// visible by 1 - 1/6, where B is 1 - (1/6)^2 / 0.7 = 0.96: 4.8 px, stop. All of it is visible, so it is refined after
// all, and its children, seen in the last frame, are drawn over it at once. Places are the same in each later frame.
Story wrong_stop_by_place() {
  Story story{"a place in the queue says too little", TrialStrategy::simp, 4.9};
  story.script = hide_second_row;
  const std::string again = "ask 1, draw 1, get 1, " + first_row_again + ", ask 2, get 2";
  story.frames = {{ahead, false, all_new}, {ahead, false, again, 1}, {ahead, false, again, 1}};
  return story;
}

// Tolerance 4 px; behind the occluder the bias of all nodes is 0.
Story front_moves_up_and_down() {
  Story story{"the front moves up behind an occluder and down when it goes", TrialStrategy::coh, 4.0};
  story.script = [](ScriptedDevice& device) {
    hide_second_row(device);
    for (const hlod::NodeId n : {0U, 1U, 3U, 4U, 5U}) {
      device.answer(1, n, hardly_visible);
      device.answer(4, n, visible);
    }
  };
  const std::string occluder_again = "ask 1/0, draw 1/0, get 1/0, ";
  story.frames = {
      {ahead, false, all_new},
      // What was refined is refined: by the last frame's answers all of it counts.
      {ahead, true, "ask 1/0, get 1/0, draw 1/0, " + first_row_again + ", ask 2, get 2"},
      // All children of node 1 stopped with a bias of 0: its own answer decides, and it is drawn.
      {ahead, true, occluder_again + "ask 1, get 1, draw 1, ask 2, get 2"},
      // The same for node 0, whose children stopped (1) or were hidden (2).
      {ahead, true, occluder_again + "ask 0, get 0, draw 0"},
      // Predicted to stop, and wrongly: its children are new, so their answers decide.
      {ahead, false,
       "ask 0, draw 0, get 0, ask 1, get 1, ask 3, get 3, draw 3, ask 4, get 4, draw 4, ask 5, get 5, "
       "draw 5, ask 2, get 2",
       1},
      {ahead, false, first_row_again + ", ask 2, get 2"},
      {ahead, false, first_row_again + ", ask 2, get 2"},
  };
  return story;
}

// The same, but there is never a hole: whatever is known to be visible is drawn before anything is asked, and a node
// that may stand for its children again is asked about while these are drawn once more. What is not known to be visible
// is asked about first.
Story front_moves_without_holes() {
  Story story{"the front moves without holes", TrialStrategy::coh, 4.0};
  story.coherence = hlod::Coherence::mended;
  story.script = [](ScriptedDevice& device) {
    hide_second_row(device);
    for (const hlod::NodeId n : {0U, 1U, 3U, 4U, 5U}) {
      device.answer(1, n, hardly_visible);
      device.answer(6, n, visible);
    }
  };
  const std::string row_drawn = "draw 3, draw 4, draw 5", row_asked = "ask 3, get 3, ask 4, get 4, ask 5, get 5";
  story.frames = {
      {ahead, false, all_new},
      // The occluder is new. What was refined is refined: by the last frame's answers all of it counts.
      {ahead, true, row_drawn + ", ask 1/0, get 1/0, draw 1/0, ask 2, get 2, " + row_asked},
      // All children of node 1 stopped with a bias of 0: it is asked about, but they are drawn.
      {ahead, true, "draw 1/0, " + row_drawn + ", ask 2, get 2, ask 1/0, get 1/0, ask 1, get 1, " + row_asked},
      {ahead, true, "draw 1/0, draw 1, ask 2, get 2, ask 1/0, get 1/0, ask 1, get 1"},
      // The same for node 0, whose children stopped (1) or were hidden (2).
      {ahead, true, "draw 1/0, draw 1, ask 2, get 2, ask 1/0, get 1/0, ask 0, get 0, ask 1, get 1"},
      {ahead, true, "draw 1/0, draw 0, ask 1/0, get 1/0, ask 0, get 0"},
      // Predicted to stop, and wrongly: its children are new, so their answers decide.
      {ahead, false,
       "draw 0, ask 0, get 0, ask 1, get 1, ask 3, get 3, draw 3, ask 4, get 4, draw 4, ask 5, get 5, "
       "draw 5, ask 2, get 2",
       1},
      {ahead, false, row_drawn + ", ask 2, get 2, " + row_asked},
      {ahead, false, row_drawn + ", ask 2, get 2, " + row_asked},
  };
  return story;
}

// Nothing is asked, so nothing is hidden.
Story frustum_only() {
  Story story{"nothing is asked", TrialStrategy::vfc};
  story.script = [](ScriptedDevice&) {};
  const std::string all = "draw 3, draw 4, draw 5, draw 6, draw 7, draw 8";
  story.frames = {{ahead, false, all}, {between, false, "draw 6, draw 7"}, {above, false, all}};
  return story;
}

}  // namespace

std::vector<Story> stories() {
  std::vector<Story> all = {frustum_only(), stop_and_wait(TrialStrategy::sw), stop_and_wait(TrialStrategy::sw_b)};
  for (const TrialStrategy strategy : {TrialStrategy::boolean, TrialStrategy::simp, TrialStrategy::coh}) {
    all.push_back(comes_and_goes(strategy));
    all.push_back(hidden_siblings(strategy));
    all.push_back(enters_a_node(strategy));
  }
  all.push_back(wrong_stop_by_place());
  all.push_back(front_moves_up_and_down());
  all.push_back(front_moves_without_holes());
  return all;
}

void expect_story(const Story& story, hlod::RenderDevice& device, bool whole_logs) {
  const hlod::Hlod rows = two_rows(story.last_rises);
  // Half as far as the first row, of which it leaves a strip of 10 % at the top.
  const hlod::Hlod occluder = one_panel({-3.0F, -0.6F, 5.0F}, {4.5F, 1.0F});
  const glm::dmat4 away = glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, 0.0, 100.0));
  const std::array<hlod::PlacedHlod, 2> objects = {{{&rows}, {&occluder, away}}};
  hlod::TrialTraverser traverser(objects);
  LoggedDevice logged(device);
  hlod::TrialOptions options;
  options.strategy = story.strategy;
  options.tolerance_px = story.tolerance_px;
  options.coherence = story.coherence;
  for (std::size_t i = 0; i < story.frames.size(); ++i) {
    const StoryFrame& frame = story.frames[i];
    SCOPED_TRACE(story.name + ", strategy " + std::to_string(static_cast<int>(story.strategy)) + ", frame " +
                 std::to_string(i) + " on " + std::string(device.name()));
    traverser.set_transform(1, frame.occluder ? glm::dmat4(1.0) : away);
    const hlod::FrameStats& stats = traverser.draw_frame(View(frame.camera), logged, options).stats;
    if (whole_logs)
      EXPECT_EQ(logged.log(), frame.log);
    else
      EXPECT_EQ(commands_of(logged.log()), commands_of(frame.log));
    EXPECT_EQ(stats.rarn, frame.rarn);
  }
}

}  // namespace occlod::test
