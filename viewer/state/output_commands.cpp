// Settings, picking, pictures and numbers.
#include <fmt/format.h>

#include "arguments.h"
#include "command.h"
#include "navigation.h"
#include "pick.h"
#include "session.h"
#include "setting_table.h"

namespace occlod::viewer {
namespace {

const Setting& setting_at(const JsonPlace& place) {
  const Setting* setting = find_setting(place.string());
  if (setting == nullptr) place.fail("is no setting", "see occlod-view --actions");
  return *setting;
}

void set(Session& session, const JsonPlace& action) {
  setting_at(action.at("setting")).set(session.state().settings, action.at("value"));
  session.setting_changed();
}

// Of toggles: the other way round. Of choices: the next one.
void flip(Session& session, const JsonPlace& action) {
  const Setting& setting = setting_at(action.at("setting"));
  nlohmann::json value = setting.get(session.state().settings);
  if (setting.kind == Setting::Kind::toggle) {
    value = !value.get<bool>();
  } else if (setting.kind == Setting::Kind::choice) {
    std::size_t i = 0;
    while (value != setting.choices[i]) ++i;
    value = setting.choices[(i + 1) % setting.choices.size()];
  } else {
    action.at("setting").fail("is a number, not a switch or a choice", "use set");
  }
  const std::string from = setting.name;
  setting.set(session.state().settings, JsonPlace(value, from));
  session.setting_changed();
}

void reset(Session& session, const JsonPlace&) {
  session.state().settings = session.state().defaults;
  session.setting_changed();
}

void pick(Session& session, const JsonPlace& action) {
  State& state = session.state();
  state.pick.reset();
  state.selected = 0;
  if (!session.frame()) return;
  const auto hit = cast_ray(*session.frame(), ray_through(state.camera, place_of(action)));
  if (!hit) return;
  state.pick = pick_of(*session.frame(), *hit);
  state.selected = state.pick->object;
}

void unpick(Session& session, const JsonPlace&) {
  session.state().pick.reset();
  session.state().selected = 0;
}

void screenshot(Session& session, const JsonPlace& action) {
  const auto panels = action.find("panels");
  session.state().captures.push_back({action.at("file").string(), panels && panels->boolean()});
}

void export_csv(Session& session, const JsonPlace& action) {
  session.timeline().write_csv(action.at("file").string());
  session.notify("wrote " + action.at("file").string());
}

void window_size(Session& session, const JsonPlace& action) {
  session.state().wanted_window = ImageSize{action.at("width").integer(320), action.at("height").integer(240)};
}

void dismiss(Session& session, const JsonPlace&) { session.state().notices.clear(); }
void quit(Session& session, const JsonPlace&) { session.state().wants_quit = true; }

}  // namespace

std::span<const Command> output_commands() {
  const Parameter file{"file", "path"}, x{"x", "in [0, 1], from the left", false},
      y{"y", "in [0, 1], from the top", false};
  static const std::vector<Command> commands = {
      {"set", "Set", "Change a setting", {{"setting", "name"}, {"value", "as its kind asks for"}}, set},
      {"flip", "Flip", "Turn a switch over, or take the next choice", {{"setting", "name"}}, flip, false},
      {"reset", "Default settings", "All settings as they were at first", {}, reset},
      {"pick", "Pick", "Pick the triangle under the cursor, its split and its object", {x, y}, pick},
      {"unpick", "Unpick", "Pick nothing", {}, unpick},
      {"screenshot",
       "Screenshot",
       "Write the picture as PNG",
       {file, {"panels", "true: the whole window", false}},
       screenshot},
      {"export_csv", "Export CSV", "Write the numbers of the last 10,000 pictures", {file}, export_csv},
      {"window_size", "Window size", "Resize the window", {{"width", "pixels"}, {"height", "pixels"}}, window_size},
      {"dismiss", "Dismiss", "Hide messages", {}, dismiss, false},
      {"quit", "Quit", "Close the viewer", {}, quit},
  };
  return commands;
}

}  // namespace occlod::viewer
