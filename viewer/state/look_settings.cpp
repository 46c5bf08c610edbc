// Lists the settings of how the mesh is drawn.
#include "setting_kinds.h"

namespace occlod::viewer {

std::span<const Setting> look_settings() {
  static const std::vector<Setting> settings = {
      choice(
          {"shading", "Shading",
           "smooth: interpolated vertex normals, except at creases; flat: one normal per triangle"},
          {"smooth", "flat"}, [](auto& s) -> auto& { return s.look.shading; }),
      number(
          {"crease_angle", "Crease angle",
           "Smooth shading keeps edges of the full mesh sharp where its faces meet at more than this angle"},
          {0.0, 180.0, false, "degrees"}, [](auto& s) -> auto& { return s.look.crease_deg; }),
      choice(
          {"color_by", "Colour by", "What the colour of a triangle stands for"},
          {"plain", "vertices", "texture", "level", "error", "slip", "visibility", "outcome", "age"},
          [](auto& s) -> auto& { return s.look.color_by; }),
      toggle(
          {"wire", "Wireframe", "Draw the edges of triangles"}, [](auto& s) -> auto& { return s.look.wire; }),
      toggle(
          {"back_faces", "Back faces", "Draw back faces, darker, instead of culling them"},
          [](auto& s) -> auto& { return s.look.back_faces; }),
      toggle(
          {"antialias", "Antialiasing", "Multisampling, four samples per pixel"},
          [](auto& s) -> auto& { return s.look.antialias; }),
      toggle(
          {"legend", "Legend", "Explain the colours in the view"}, [](auto& s) -> auto& { return s.window.legend; }),
      toggle(
          {"bounds", "Picked: bounds", "Show the bounding volume of the picked split that occlusion queries test"},
          [](auto& s) -> auto& { return s.look.bounds; }),
      toggle(
          {"cone", "Picked: normals", "Show the normal cone of the picked split: the normals of all faces below it"},
          [](auto& s) -> auto& { return s.look.cone; }),
      not_kept(toggle(
          {"birdseye", "Bird's-eye inset", "Show the scene from above, with the view frustum of the refinement"},
          [](auto& s) -> auto& { return s.insets.birdseye; })),
      not_kept(toggle(
          {"occluder", "Occluder inset", "Show the depth of the last occluder"},
          [](auto& s) -> auto& { return s.insets.occluder; })),
      not_kept(integer(
          {"pyramid_level", "Pyramid level",
           "Level of the occluder's depth pyramid; each texel holds the farthest of 2x2 of the level below"},
          {0, 15, false, ""}, [](auto& s) -> auto& { return s.insets.pyramid_level; })),
  };
  return settings;
}

}  // namespace occlod::viewer
