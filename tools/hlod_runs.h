// Draws one camera path by several strategies, each on its device, frame by frame in turns.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "front_mesh.h"
#include "hlod_reference.h"
#include "hlod_scene.h"
#include "json_output.h"
#include "occlod/device.h"
#include "occlod/traverser.h"

namespace occlod::tool {

struct HlodRun {
  hlod::TraverseOptions options;
  hlod::RenderDevice* device = nullptr;  // may be shared with other runs
  const hlod::Trial* trial = nullptr;    // for comparisons with papers; null: none
};

class HlodRuns {
 public:
  // Compares `compared_frames` frames, spread evenly over the path, or all if there are no more, with the input. All
  // runs have the tolerance, metric and geomorphs of the first. The scene, the devices and the trials must outlive it.
  HlodRuns(const HlodScene& scene, std::vector<HlodRun> runs, int compared_frames);

  // Draws frame `frame` of the path by each run. Frames must be drawn in order from 0.
  void draw(int frame);

  // These return the last frame of a run, what it drew, and its data for reports.
  [[nodiscard]] const hlod::Frame& frame(std::size_t run) const { return *states_[run].frame; }
  [[nodiscard]] const Front& front(std::size_t run) const { return states_[run].front; }
  [[nodiscard]] const Json& told(std::size_t run) const { return states_[run].rows.back(); }
  // Returns the data of all frames so far.
  [[nodiscard]] const std::vector<Json>& rows(std::size_t run) const { return states_[run].rows; }
  // Returns averages over all frames, the largest of values that are called largest or resident, sums of what was
  // loaded, and a hash of all fronts.
  [[nodiscard]] Json summary(std::size_t run) const;

 private:
  struct State {
    HlodRun run;
    hlod::Traverser traverser;
    const hlod::Frame* frame = nullptr;
    Front front;
    std::vector<Json> rows;
  };
  [[nodiscard]] bool is_compared(int frame) const;
  void draw(State& state, int frame, const View& view);

  const HlodScene& scene_;
  int compared_frames_;
  std::vector<State> states_;
  std::optional<HlodReference> reference_;
};

}  // namespace occlod::tool
