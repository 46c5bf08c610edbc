// Lists the settings of what is looked at closely: what stands beside the mesh, the clipping plane, and measuring.
#include "setting_kinds.h"

namespace occlod::viewer {

std::span<const Setting> study_settings() {
  static const std::vector<Setting> settings = {
      not_kept(choice(
          {"beside", "Beside it",
           "Split screen of meshes. other: the same budget without occlusion; full: the full meshes; difference: how "
           "far the depth of each pixel is from theirs, in pixels"},
          {"other", "full", "difference"}, [](auto& s) -> auto& { return s.beside; })),
      not_kept(choice(
          {"clip_axis", "Clipping plane", "Draw only what lies on one side of a plane across this axis of the world"},
          {"none", "x", "y", "z"}, [](auto& s) -> auto& { return s.clip.axis; })),
      not_kept(number(
          {"clip_at", "Clip at", "Place of the clipping plane, as a share of the scene's extent along the axis"},
          {0.0, 1.0, false, ""}, [](auto& s) -> auto& { return s.clip.at; })),
      not_kept(toggle(
          {"clip_flip", "Clip the other side", "Draw what lies beyond the clipping plane, instead of before it"},
          [](auto& s) -> auto& { return s.clip.flip; })),
      not_kept(toggle(
          {"measuring", "Measure", "Clicks on the mesh set the two ends of a distance, and pick nothing"},
          [](auto& s) -> auto& { return s.measure; })),
  };
  return settings;
}

}  // namespace occlod::viewer
