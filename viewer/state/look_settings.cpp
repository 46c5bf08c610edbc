// How the mesh is drawn.
#include "setting_kinds.h"

namespace occlod::viewer {

std::span<const Setting> look_settings() {
  static const std::vector<Setting> settings = {
      choice(
          {"shading", "Shading", "smooth: vertex normals; flat: one for each triangle"}, {"smooth", "flat"},
          [](auto& s) -> auto& { return s.look.shading; }),
      choice(
          {"color_by", "Colour by", "What a triangle's colour tells"},
          {"plain", "vertices", "level", "error", "visibility", "outcome", "age"},
          [](auto& s) -> auto& { return s.look.color_by; }),
      toggle(
          {"wire", "Wire", "Lines along the edges of triangles"}, [](auto& s) -> auto& { return s.look.wire; }),
      toggle(
          {"back_faces", "Back faces", "Draw them, darker"}, [](auto& s) -> auto& { return s.look.back_faces; }),
      toggle(
          {"antialias", "Smooth edges", "Four samples a pixel"}, [](auto& s) -> auto& { return s.look.antialias; }),
      toggle(
          {"legend", "Legend", "What the colours mean"}, [](auto& s) -> auto& { return s.window.legend; }),
      toggle(
          {"bounds", "Picked: bounds", "Of the picked split: the proxy that is asked about, sphere, box or cylinder"},
          [](auto& s) -> auto& { return s.look.bounds; }),
      toggle(
          {"cone", "Picked: normals", "Of the picked split: the cone that holds the normals of all faces below it"},
          [](auto& s) -> auto& { return s.look.cone; }),
      not_kept(toggle(
          {"birdseye", "Bird's-eye inset", "From above, with the frustum that is refined for"},
          [](auto& s) -> auto& { return s.insets.birdseye; })),
      not_kept(toggle(
          {"occluder", "Occluder inset", "The depth that hid what is hidden"},
          [](auto& s) -> auto& { return s.insets.occluder; })),
      not_kept(integer(
          {"pyramid_level", "Pyramid level", "Of the occluder's depth: each holds the farthest of 2x2"},
          {0, 15, false, ""}, [](auto& s) -> auto& { return s.insets.pyramid_level; })),
  };
  return settings;
}

}  // namespace occlod::viewer
