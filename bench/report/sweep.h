// Refines scenes along their camera paths with every setting and measures what comes of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "beside_hlod.h"
#include "occlod/picture.h"
#include "report/measures.h"
#include "report/settings.h"
#include "visibility/scene_run.h"

namespace occlod::bench {

struct ScenePath {
  std::string scene;  // as scene_file() takes it
  std::string path;
};

struct SweepOptions {
  std::vector<ScenePath> scenes = {
      {"armadillo_group", "orbit"}, {"planet_near", "low_flight"}, {"sponza", "walk"}, {"city", "walk"}};
  std::vector<std::size_t> budgets = {1'000, 2'000, 5'000, 10'000, 20'000, 50'000, 100'000};
  std::size_t knob_budget = 10'000;
  tool::ImageSize size{1024, 768};
  tool::ImageSize hidden_size{384, 288};  // of the pictures that wrongly hidden pixels are counted in
  int bursts = 3;                         // runs of consecutive frames, spread over a path
  int burst_frames = 6;                   // of which the first is not timed and the last is looked at; at least 2
};

// What one setting does to one scene, or to all of them.
struct Outcome {
  double refine_ms = 0.0;  // medians of frames; of all scenes the geometric means of these
  double occlusion_ms = 0.0;
  double ms = 0.0;  // of the sum of both
  double draw_ms = 0.0;
  double triangles = 0.0;
  Measured measured{};
  std::uint64_t hash = 0;  // of all refinements
  std::vector<Measured> pictures;
};

struct SceneOutcomes {
  std::string scene;
  std::string path;
  std::size_t full_triangles = 0;
  std::vector<int> frames;          // that were looked at
  std::vector<Outcome> outcomes;    // of the settings, in their order
  std::vector<tool::WayCost> ways;  // splits and HLODs
};

// Some consecutive frames.
struct Burst {
  std::vector<Camera> cameras;
  int last_frame = 0;
};
// The i-th of a path: their middles are spread evenly over it. Throws Error for a path that the scene does not have.
[[nodiscard]] Burst burst_of(const SceneRun& run, const std::string& path, int i, const SweepOptions& options);

// In a burst every frame is refined with every setting before the next frame is, so that all of them see the same
// machine.
[[nodiscard]] SceneOutcomes sweep_scene(SceneRun& run, const std::string& path, const std::vector<Setting>& settings,
                                        const SweepOptions& options);

[[nodiscard]] std::vector<Outcome> over_all_scenes(const std::vector<SceneOutcomes>& scenes);

}  // namespace occlod::bench
