// Lists the settings of the camera's motion and of the window itself.
#include "setting_kinds.h"

namespace occlod::viewer {

std::span<const Setting> camera_settings() {
  static const std::vector<Setting> settings = {
      choice(
          {"steering", "Steering", "orbit: around the target; fly: freely; walk: along the ground"},
          {"orbit", "fly", "walk"}, [](auto& s) -> auto& { return s.steering; }),
      number(
          {"speed", "Speed", "Speed of flying and walking, in scene radii per second"}, {0.01, 10.0, true, "radii/s"},
          [](auto& s) -> auto& { return s.speed; }),
      number(
          {"playback_rate", "Playback rate", "Frames of a camera path per picture that is drawn"},
          {0.1, 10.0, true, ""}, [](auto& s) -> auto& { return s.playback_rate; }),
  };
  return settings;
}

std::span<const Setting> window_settings() {
  static const std::vector<Setting> settings = {
      toggle(
          {"sidebar", "Sidebar", "Show the panels on the left"}, [](auto& s) -> auto& { return s.window.sidebar; }),
      toggle(
          {"graph", "Time graph", "Show the numbers and the time graph at the bottom"},
          [](auto& s) -> auto& { return s.window.graph; }),
      not_kept(toggle(
          {"help", "Help", "List keys and mouse actions"}, [](auto& s) -> auto& { return s.window.help; })),
      number(
          {"scale", "Scale", "Size of text and panels; 0: as the display asks for"}, {0.0, 4.0, false, ""},
          [](auto& s) -> auto& { return s.window.scale; }),
      choice(
          {"theme", "Theme", "Colours of the panels"}, {"dark", "light"},
          [](auto& s) -> auto& { return s.window.theme; }),
      choice(
          {"plot", "Graph shows",
           "What the graph at the bottom shows of the last pictures: their times, triangles, the share of these that "
           "is "
           "visible, or the largest error"},
          {"times", "triangles", "visible", "error"}, [](auto& s) -> auto& { return s.window.plot; }),
  };
  return settings;
}

}  // namespace occlod::viewer
