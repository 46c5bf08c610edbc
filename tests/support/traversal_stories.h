// Short stories, told frame by frame, with the exact sequence of draws and questions that each strategy must give. The
// meshes are real and stand so that every device that answers at once gives these sequences.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "papers/trial_traverser.h"
#include "support/scripted_device.h"

namespace occlod::test {

struct StoryFrame {
  Camera camera;
  bool occluder = false;  // a panel stands before the first row
  std::string log;        // as LoggedDevice writes it
  std::size_t rarn = 0;   // FrameStats::rarn
};

// About two_rows(), which is object 0, and the occluder, object 1.
struct Story {
  std::string name;
  hlod::TrialStrategy strategy = hlod::TrialStrategy::sw;
  double tolerance_px = 1.0;
  bool last_rises = false;  // of two_rows()
  hlod::Coherence coherence = hlod::Coherence::published;
  std::function<void(ScriptedDevice&)> script = {};  // what a scripted device has to answer
  std::vector<StoryFrame> frames = {};
};

[[nodiscard]] std::vector<Story> stories();

// Plays a story. With a scripted device, whole logs are compared; with any other, the draws and questions.
void expect_story(const Story& story, hlod::RenderDevice& device, bool whole_logs);

}  // namespace occlod::test
