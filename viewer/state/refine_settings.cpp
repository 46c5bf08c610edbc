// How the mesh is refined: one entry for each field of RefineOptions, the backend, and whether from frame to frame.
#include "setting_kinds.h"

namespace occlod::viewer {

std::span<const Setting> refine_settings() {
  static const std::vector<Setting> settings = {
      integer(
          {"budget", "Triangles", "No more triangles than this, whatever the view"}, {1'000, 10'000'000, true, ""},
          [](auto& s) -> auto& { return s.refine.budget; }),
      number(
          {"tolerance", "Tolerance", "Stop where the guaranteed error is below this; 0 uses the budget up"},
          {0.0, 16.0, false, "px"}, [](auto& s) -> auto& { return s.refine.tolerance_px; }),
      choice(
          {"occlusion", "Occlusion",
           "Who answers whether a part of the mesh is hidden; auto: whatever pays in each view, in place of Level "
           "step, "
           "Occluder after, Ask again and Final check"},
          {"none", "software", "gl-query", "gl-mark", "gl-compute", "auto"},
          [](auto& s) -> auto& { return s.occlusion; }),
      choice(
          {"mode", "Occluder", "paper: the coarse mesh as it is; conservative: moved back by its error bounds"},
          {"paper", "conservative"}, [](auto& s) -> auto& { return s.refine.occluder.mode; }),
      choice(
          {"culling", "Culling", "subtree: the paper's one question; star: ask of each split whether it is seen"},
          {"subtree", "star"}, [](auto& s) -> auto& { return s.refine.priority.culling; }),
      choice(
          {"proxy", "Proxy", "The bounds of a subtree that are asked about"}, {"sphere", "box", "cylinder"},
          [](auto& s) -> auto& { return s.refine.queries.proxy; }),
      number(
          {"visible_exponent", "Visible weight", "Priority is multiplied by (visible share of a split)^this"},
          {0.0, 8.0, false, ""}, [](auto& s) -> auto& { return s.refine.priority.visible_exponent; }),
      number(
          {"grazing_exponent", "Grazing weight", "Priority is divided by (cosine under which a split is seen)^this"},
          {0.0, 8.0, false, ""}, [](auto& s) -> auto& { return s.refine.priority.grazing_exponent; }),
      number(
          {"forced_exponent", "Forced weight", "Priority is divided by (1 + unseen splits that a split forces)^this"},
          {0.0, 8.0, false, ""}, [](auto& s) -> auto& { return s.refine.priority.forced_exponent; }),
      integer(
          {"level_step", "Level step", "Ask about subtrees on every n-th level of the forest only"}, {1, 16, false, ""},
          [](auto& s) -> auto& { return s.refine.queries.level_step; }),
      integers(
          {"occluder_splits", "Occluder after",
           "Draw the occluder when so many splits are applied; none: when it pays"},
          [](auto& s) -> auto& { return s.refine.occluder.splits; }),
      toggle(
          {"retest_hidden", "Ask again", "What an older occluder hid, whenever a new one is drawn"},
          [](auto& s) -> auto& { return s.refine.occluder.retest_hidden; }),
      toggle(
          {"final_check", "Final check", "Ask about all that is hidden once more, before the final mesh"},
          [](auto& s) -> auto& { return s.refine.queries.final_check; }),
      toggle(
          {"frame_to_frame", "Frame to frame", "Go on from the mesh of the picture before instead of from scratch"},
          [](auto& s) -> auto& { return s.frame_to_frame; }),
      number(
          {"hysteresis", "Hysteresis", "Frame to frame: a split gives way only to what matters more by this part"},
          {0.0, 0.9, false, ""}, [](auto& s) -> auto& { return s.refine.update.hysteresis; }),
      integer(
          {"most_changes", "Changes", "Frame to frame: splits and merges for a picture; 0 sets no limit"},
          {0, 100'000, true, ""}, [](auto& s) -> auto& { return s.refine.update.most_changes; }),
      number(
          {"time_limit", "Time limit", "Frame to frame: no more splits and merges for a picture after it; 0: none"},
          {0.0, 100.0, false, "ms"}, [](auto& s) -> auto& { return s.refine.update.time_limit_ms; }),
      integer(
          {"geomorph_frames", "Geomorphs", "Frame to frame: pictures in which a new vertex slides to its place"},
          {0, 120, false, ""}, [](auto& s) -> auto& { return s.refine.update.geomorph_frames; }),
      not_kept(toggle(
          {"freeze", "Freeze", "Keep the mesh of this moment and look at it from elsewhere"},
          [](auto& s) -> auto& { return s.freeze; })),
      not_kept(toggle(
          {"compare", "Split screen", "Beside it the same view and budget without occlusion"},
          [](auto& s) -> auto& { return s.compare; })),
      toggle(
          {"count_visible", "Count visible", "Triangles that own at least one pixel, by an item buffer"},
          [](auto& s) -> auto& { return s.count_visible; }),
  };
  return settings;
}

}  // namespace occlod::viewer
