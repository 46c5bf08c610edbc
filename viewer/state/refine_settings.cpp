// Lists the settings of refinement: the fields of RefineOptions, knobs worth a look, the backend, and frame to frame.
#include <algorithm>
#include <iterator>
#include <vector>

#include "refine/tuning.h"
#include "setting_kinds.h"

namespace occlod::viewer {
namespace {

// Settings are also read from constant ones.
Tuning& knobs(RefineOptions& options) { return tune(options); }
const Tuning& knobs(const RefineOptions& options) { return tuning_of(options); }

// These apply to every view.
std::vector<Setting> view_settings() {
  return {
      integer(
          {"budget", "Triangles", "Triangle budget: the mesh never has more, in any view"},
          {1'000, 10'000'000, true, ""}, [](auto& s) -> auto& { return s.refine.budget; }),
      number(
          {"tolerance", "Tolerance",
           "Stop splitting where the guaranteed screen-space error is below this; 0: use the whole budget"},
          {0.0, 16.0, false, "px"}, [](auto& s) -> auto& { return s.refine.tolerance_px; }),
      choice(
          {"occlusion", "Occlusion",
           "Backend of occlusion queries. picture: frame to frame, the picture before is the occluder; auto: picks the "
           "culling techniques that pay off in each view; "
           "Occluder after and Final check then have no effect"},
          {"none", "software", "picture", "gl-query", "auto"}, [](auto& s) -> auto& { return s.occlusion; }),
      choice(
          {"mode", "Occluder mode",
           "paper: the coarse mesh as it is; conservative: only what stays hidden wherever the true surface may be"},
          {"paper", "conservative"}, [](auto& s) -> auto& { return s.refine.mode; }),
      choice(
          {"culling", "Culling",
           "subtree: one test for each subtree, as in the paper; star: also test what each split itself changes"},
          {"subtree", "star"}, [](auto& s) -> auto& { return knobs(s.refine).culling; }),
      choice(
          {"proxy", "Proxy", "Bounding volume of a subtree that occlusion queries test"}, {"sphere", "box", "cylinder"},
          [](auto& s) -> auto& { return knobs(s.refine).proxy; }),
      integers(
          {"occluder_splits", "Occluder after",
           "Draw the occluder after these numbers of splits, e.g. 300, 2500; empty: at a third of the budget in "
           "triangles and at sixths of that"},
          [](auto& s) -> auto& { return knobs(s.refine).occluder_splits; }),
      toggle(
          {"final_check", "Final check", "Query everything that is hidden once more before the mesh is final"},
          [](auto& s) -> auto& { return knobs(s.refine).final_check; }),
  };
}

// These tell how one frame follows another, and what is shown of it.
std::vector<Setting> frame_settings() {
  return {
      toggle(
          {"frame_to_frame", "Frame to frame", "Start from the mesh of the previous frame instead of the base mesh"},
          [](auto& s) -> auto& { return s.frame_to_frame; }),
      number(
          {"hysteresis", "Hysteresis",
           "Frame to frame: relative margin by which a candidate must exceed an applied split to replace it"},
          {0.0, 0.9, false, ""}, [](auto& s) -> auto& { return knobs(s.refine).hysteresis; }),
      integer(
          {"max_changes", "Most changes", "Frame to frame: limit on splits and merges per frame; 0: no limit"},
          {0, 100'000, true, ""}, [](auto& s) -> auto& { return s.refine.max_changes; }),
      number(
          {"time_limit", "Time limit",
           "Frame to frame: no further splits and merges in a frame after this time; 0: no limit"},
          {0.0, 100.0, false, "ms"}, [](auto& s) -> auto& { return s.refine.time_limit_ms; }),
      integer(
          {"geomorph_frames", "Geomorphs",
           "Frame to frame: frames in which a new vertex moves from its parent to its own position; 0: at once"},
          {0, 120, false, ""}, [](auto& s) -> auto& { return s.refine.geomorph_frames; }),
      not_kept(toggle(
          {"freeze", "Freeze", "Keep the mesh as it is now and move only the camera that views it"},
          [](auto& s) -> auto& { return s.freeze; })),
      not_kept(toggle(
          {"compare", "Split screen",
           "Show the same view and budget without occlusion beside it, or an HLOD by another strategy"},
          [](auto& s) -> auto& { return s.compare; })),
      toggle(
          {"count_visible", "Count visible", "Count triangles that own at least one pixel, with an item buffer"},
          [](auto& s) -> auto& { return s.count_visible; }),
  };
}

}  // namespace

std::span<const Setting> refine_settings() {
  static const std::vector<Setting> settings = [] {
    std::vector<Setting> all = view_settings();
    std::ranges::move(frame_settings(), std::back_inserter(all));
    return all;
  }();
  return settings;
}

}  // namespace occlod::viewer
