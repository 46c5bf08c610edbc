// How the camera moves, and the window itself.
#include "setting_kinds.h"

namespace occlod::viewer {

std::span<const Setting> camera_settings() {
  static const std::vector<Setting> settings = {
      choice(
          {"steering", "Steering", "orbit: around what is looked at; fly: freely; walk: on the ground"},
          {"orbit", "fly", "walk"}, [](auto& s) -> auto& { return s.steering; }),
      number(
          {"speed", "Speed", "Of flying and walking, in radii of the scene a second"}, {0.01, 10.0, true, "radii/s"},
          [](auto& s) -> auto& { return s.speed; }),
      number(
          {"playback_rate", "Playback rate", "Frames of a camera path for each picture"}, {0.1, 10.0, true, ""},
          [](auto& s) -> auto& { return s.playback_rate; }),
  };
  return settings;
}

std::span<const Setting> window_settings() {
  static const std::vector<Setting> settings = {
      toggle(
          {"sidebar", "Sidebar", "The panels on the left"}, [](auto& s) -> auto& { return s.window.sidebar; }),
      toggle(
          {"graph", "Time graph", "The strip at the bottom"}, [](auto& s) -> auto& { return s.window.graph; }),
      not_kept(toggle(
          {"help", "Help", "Keys and mouse"}, [](auto& s) -> auto& { return s.window.help; })),
      number(
          {"scale", "Size of text", "0: as the display says"}, {0.0, 4.0, false, ""},
          [](auto& s) -> auto& { return s.window.scale; }),
  };
  return settings;
}

}  // namespace occlod::viewer
