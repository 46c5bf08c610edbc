// One camera path drawn by several strategies, each on its device, frame by frame in turns.
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
  hlod::RenderDevice* device = nullptr;  // may be that of other runs too
  const hlod::Trial* trial = nullptr;    // for comparisons with papers; null: none
};

class HlodRuns {
 public:
  // `compared_frames`, spread evenly over the path, are compared with the truth; all when there are no more. All runs
  // have the tolerance, metric and geomorphs of the first. The scene, the devices and the trials outlive it.
  HlodRuns(const HlodScene& scene, std::vector<HlodRun> runs, int compared_frames);

  // Draws frame `frame` of the path by each run. In order, from frame 0.
  void draw(int frame);

  // Of run `run`: the last frame, what it drew, and what is told of it.
  [[nodiscard]] const hlod::Frame& frame(std::size_t run) const { return *states_[run].frame; }
  [[nodiscard]] const Front& front(std::size_t run) const { return states_[run].front; }
  [[nodiscard]] const Json& told(std::size_t run) const { return states_[run].rows.back(); }
  // Of all frames so far.
  [[nodiscard]] const std::vector<Json>& rows(std::size_t run) const { return states_[run].rows; }
  // Averages over them, the largest of what is called largest and of what is resident, sums of what was loaded, and a
  // hash of all fronts.
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
