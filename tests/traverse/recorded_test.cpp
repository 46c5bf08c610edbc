// A recorded run, replayed from its file: the same calls, so the same fronts, wherever answers come from.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "papers/trial_devices.h"
#include "papers/trial_traverser.h"
#include "traverse/small_scenes.h"

namespace occlod::hlod {
namespace {

using namespace test;

constexpr int frames = 12;

struct FrameResult {
  std::uint64_t front_hash;
  std::size_t queries, delayed, visits;
  FrameTimes times;
  bool operator==(const FrameResult&) const = default;
};

TrialOptions options_of(TrialStrategy strategy, double tolerance_px) {
  TrialOptions options;
  options.strategy = strategy;
  options.tolerance_px = tolerance_px;
  return options;
}

std::vector<FrameResult> walk_through(const Hlod& hlod, RenderDevice& device, const TrialOptions& options) {
  const PlacedHlod placed{&hlod};
  TrialTraverser traverser({&placed, 1});
  std::vector<FrameResult> results;
  for (int i = 0; i < frames; ++i) {
    const Frame& frame = traverser.draw_frame(View(walk(hlod.data().box, i, frames)), device, options);
    results.push_back({frame.front_hash, frame.stats.queries, frame.stats.delayed, frame.stats.visits, frame.times});
  }
  return results;
}

// On a device whose answers come late, and at times that depend on what is drawn.
TEST(RecordedTraversal, HasTheSameFronts) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "occlod_recorded_traversal.orec";
  for (const TrialStrategy strategy : asking_strategies) {
    const TrialOptions options = options_of(strategy, 0.5);
    VirtualDevice device(device_preset("query-dear"));
    RecordingDevice recorder(device);
    const std::vector<FrameResult> run = walk_through(city(Grouping::shifted), recorder, options);
    write_recording(file, recorder.recording());
    ReplayingDevice replay(read_recording(file));
    EXPECT_EQ(walk_through(city(Grouping::shifted), replay, options), run);
    EXPECT_GT(run.back().queries, 0U);
  }
  std::filesystem::remove(file);
}

TEST(RecordedTraversal, SaysWhereAnotherRunLeavesIt) {
  VirtualDevice device(device_preset("query-dear"));
  RecordingDevice recorder(device);
  (void)walk_through(city(Grouping::shifted), recorder, options_of(TrialStrategy::coh, 0.5));
  const auto refusal = [&](const Hlod& hlod, const TrialOptions& options) -> std::string {
    ReplayingDevice replay(recorder.recording());
    try {
      (void)walk_through(hlod, replay, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(city(Grouping::shifted), options_of(TrialStrategy::coh, 0.5)), "");
  EXPECT_EQ(refusal(city(Grouping::shifted), options_of(TrialStrategy::sw, 0.5)).rfind("replay: frame 0", 0), 0U);
  EXPECT_EQ(refusal(city(Grouping::shifted), options_of(TrialStrategy::coh, 2.0)).rfind("replay: frame ", 0), 0U);
  EXPECT_EQ(refusal(planet(Grouping::shifted), options_of(TrialStrategy::coh, 0.5))
                .rfind("replay: frame 0, command 0: is told begin_frame in another view or with other HLODs", 0),
            0U);
}

}  // namespace
}  // namespace occlod::hlod
