// What a camera that stands still comes to draw where answers are late.
#include <gtest/gtest.h>

#include "occlod/device.h"
#include "papers/trial_devices.h"
#include "traverse/small_scenes.h"

namespace occlod::hlod {
namespace {

struct Drawn {
  std::size_t nodes = 0;
  std::uint64_t front = 0;
};

// In the last of so many frames, of which the first knows nothing.
Drawn drawn_at_last(const Camera& camera, TrialStrategy strategy, RenderDevice& device, int frames) {
  const PlacedHlod placed[] = {{&test::city(Grouping::nested)}};
  TrialTraverser traverser(placed);
  TrialOptions options;
  options.strategy = strategy;
  options.tolerance_px = 2.0;
  options.bias = {1.0, 0.1};
  Drawn drawn;
  for (int i = 0; i < frames; ++i) {
    const Frame& frame = traverser.draw_frame(View(camera), device, options);
    drawn = {frame.stats.drawn_nodes, frame.front_hash};
  }
  return drawn;
}

// In the first frame nothing is drawn when the questions are asked, and the answers come when all of them have been:
// everything is seen through a hole. What is refined for that would stay refined, because the biases of its children
// do not tell that it shows too little. It is asked again when the hole is filled, so the front becomes the one that is
// drawn where each answer is waited for before the next question.
TEST(StandingStill, DrawsWithLateAnswersWhatItDrawsWhereEachIsWaitedFor) {
  constexpr int cameras = 24;
  std::size_t waited = 0, late = 0;
  for (int i = 0; i < cameras; ++i) {
    Camera camera = test::walk(test::city(Grouping::nested).data().box, i, cameras);
    camera.width = 640;
    camera.height = 480;
    SoftwareDevice prompt_device;
    VirtualDevice late_device(device_preset("modern"));
    const Drawn at_once = drawn_at_last(camera, TrialStrategy::coh, prompt_device, 12);
    const Drawn at_last = drawn_at_last(camera, TrialStrategy::coh, late_device, 12);
    EXPECT_EQ(at_last.front, at_once.front) << "camera " << i;
    EXPECT_EQ(drawn_at_last(camera, TrialStrategy::coh, late_device, 13).front, at_last.front) << "camera " << i;
    waited += drawn_at_last(camera, TrialStrategy::sw_b, prompt_device, 1).nodes;
    late += at_last.nodes;
  }
  EXPECT_LE(static_cast<double>(late), 1.005 * static_cast<double>(waited));
}

}  // namespace
}  // namespace occlod::hlod
