// Implements the commands of settings, picking, pictures and numbers.
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
  if (setting == nullptr)
    place.fail(fmt::format("\"{}\" is not a setting", place.string()), "see occlod-view --actions");
  return *setting;
}

void set(Session& session, const JsonPlace& action) {
  assign(setting_at(action.at("setting")), session.state().settings, action.at("value"));
  session.setting_changed();
}

// Inverts a toggle, or takes the next of several choices.
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
    action.at("setting").fail(fmt::format("{} is neither a switch nor a choice", setting.name), "use set");
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
  const auto hit = cast_ray(*session.frame(), ray_through(state.camera, place_of(action)),
                            clip_plane(state.settings.clip, *state.objects));
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
  const bool with_panels = panels && panels->boolean();
  session.state().captures.push_back(
      {session.files().output(action.at("file"), OutputKind::picture, *session.state().objects), with_panels});
}

void export_csv(Session& session, const JsonPlace& action) {
  const auto file = session.files().output(action.at("file"), OutputKind::numbers, *session.state().objects);
  session.timeline().write_csv(file);
  session.notify("wrote " + file.string());
}

void window_size(Session& session, const JsonPlace& action) {
  const ImageSize size{action.at("width").integer(1), action.at("height").integer(1)};
  if (!is_window_size(size))
    action.fail(fmt::format("is not between {}x{} and {}x{} pixels", min_window.width, min_window.height,
                            max_window.width, max_window.height));
  session.state().wanted_window = size;
}

void dismiss(Session& session, const JsonPlace&) { session.state().notices.clear(); }
void quit(Session& session, const JsonPlace&) { session.state().wants_quit = true; }

}  // namespace

std::span<const Command> output_commands() {
  const Parameter file{"file", "path"}, x{"x", "in [0, 1], from the left", false},
      y{"y", "in [0, 1], from the top", false};
  static const std::vector<Command> commands = {
      {"set", "Set", "Change a setting", {{"setting", "name"}, {"value", "as its kind asks for"}}, set},
      {"flip", "Flip", "Toggle a switch, or go to the next choice", {{"setting", "name"}}, flip, false},
      {"reset", "Default settings", "Set every setting back to its default", {}, reset},
      {"pick", "Pick", "Pick the triangle under the cursor, its split and its object", {x, y}, pick},
      {"unpick", "Unpick", "Clear the picked triangle", {}, unpick},
      {"screenshot",
       "Screenshot",
       "Write the picture to a PNG file",
       {file, {"panels", "true: the whole window with its panels", false}},
       screenshot},
      {"export_csv", "Export CSV", "Write the numbers of the last 10,000 pictures to a CSV file", {file}, export_csv},
      {"window_size", "Window size", "Resize the window", {{"width", "pixels"}, {"height", "pixels"}}, window_size},
      {"dismiss", "Dismiss", "Dismiss all messages", {}, dismiss, false},
      {"quit", "Quit", "Close the viewer", {}, quit},
  };
  return commands;
}

}  // namespace occlod::viewer
