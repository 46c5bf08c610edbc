#include "view_input.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>
#include <utility>

#include "keys.h"

namespace occlod::viewer {
namespace {

constexpr float click_px = 4.0F;     // a press that moves less is a click
constexpr double orbit_deg = 220.0;  // for a drag across the picture's height
constexpr double look_deg = 90.0;
constexpr double zoom_a_notch = 0.88;
constexpr double speed_a_notch = 1.2;
constexpr double fast = 4.0;

const Area* picture_under(const Layout& layout, const ImVec2& p) {
  for (const Area& picture : layout.pictures)
    if (picture.holds(p)) return &picture;
  return nullptr;
}

nlohmann::json place_in(const Area& picture, const ImVec2& p) {
  const auto share = [](float value) { return static_cast<double>(std::clamp(value, 0.0F, 1.0F)); };
  return {{"x", share((p.x - picture.low.x) / picture.width())},
          {"y", share((p.y - picture.low.y) / picture.height())}};
}

void set(Panels& panels, const char* setting, const nlohmann::json& value) {
  panels.perform("set", {{"setting", setting}, {"value", value}});
}

}  // namespace

void ViewInput::update(Panels& panels, const Layout& layout, const glm::dvec3& held, double seconds) {
  const ImGuiIO& io = ImGui::GetIO();
  moves_ = held != glm::dvec3(0.0) && !panels.takes_keys();
  if (moves_) {
    const glm::dvec3 by = held * (io.KeyShift ? fast : 1.0);
    panels.perform("move", {{"right", by.x}, {"up", by.y}, {"ahead", by.z}, {"seconds", std::min(seconds, 0.1)}});
  }
  if (button_ >= 0) {
    if (!ImGui::IsMouseDown(button_)) {
      release(panels);
    } else if (io.MouseDelta.x != 0.0F || io.MouseDelta.y != 0.0F) {
      const ImVec2 from_start(io.MousePos.x - start_.x, io.MousePos.y - start_.y);
      moved_ = moved_ || std::hypot(from_start.x, from_start.y) > click_px * panels.scale;
      if (moved_) drag(panels, io.MouseDelta);
    }
  } else if (!io.WantCaptureMouse) {
    press(panels, layout);
  }
  if (!io.WantCaptureMouse && io.MouseWheel != 0.0F) wheel(panels, layout, io.MouseWheel);
}

void ViewInput::press(Panels& panels, const Layout& layout) {
  const ImGuiIO& io = ImGui::GetIO();
  const Area* picture = picture_under(layout, io.MousePos);
  if (picture == nullptr) return;
  for (int button = 0; button < 3; ++button) {
    if (!ImGui::IsMouseClicked(button)) continue;
    if (button == 0 && ImGui::IsMouseDoubleClicked(0)) {
      panels.perform("look_at", place_in(*picture, io.MousePos));
      return;
    }
    button_ = button;
    moved_ = false;
    start_ = io.MousePos;
    picture_ = *picture;
    drags_object_ = button == 0 && io.KeyCtrl;
    if (drags_object_) panels.perform("pick", place_in(picture_, start_));
    return;
  }
}

void ViewInput::drag(Panels& panels, const ImVec2& by) {
  const double right = static_cast<double>(by.x / picture_.width());
  const double up = static_cast<double>(-by.y / picture_.height());
  const State& state = panels.session.state();
  const double aspect = static_cast<double>(picture_.width() / picture_.height());
  if (drags_object_) {
    if (state.selected != 0) panels.perform("drag", {{"right", right}, {"up", up}});
  } else if (button_ != 0 || ImGui::GetIO().KeyShift) {
    panels.perform("pan", {{"right", -right}, {"up", -up}});
  } else if (state.settings.steering == Steering::orbit) {
    panels.perform("orbit", {{"right", right * aspect * orbit_deg}, {"up", up * orbit_deg}});
  } else {
    panels.perform("look", {{"right", right * aspect * look_deg}, {"up", up * look_deg}});
  }
}

void ViewInput::release(Panels& panels) {
  const bool measures = panels.session.state().settings.measure;
  if (button_ == 0 && !moved_ && !drags_object_)
    panels.perform(measures ? "measure" : "pick", place_in(picture_, start_));
  button_ = -1;
}

void ViewInput::wheel(Panels& panels, const Layout& layout, float notches) {
  const ImGuiIO& io = ImGui::GetIO();
  const Area* picture = picture_under(layout, io.MousePos);
  if (picture == nullptr) return;
  const State& state = panels.session.state();
  if (state.settings.steering == Steering::orbit) {
    nlohmann::json arguments = place_in(*picture, io.MousePos);
    arguments["factor"] = std::pow(zoom_a_notch, static_cast<double>(notches));
    panels.perform("zoom", arguments);
  } else {
    const double speed = state.settings.speed * std::pow(speed_a_notch, static_cast<double>(notches));
    set(panels, "speed", std::clamp(speed, 0.01, 10.0));
  }
}

namespace {

void press_digit(Panels& panels, std::size_t digit) {
  const auto& bookmarks = panels.session.state().bookmarks;
  if (digit >= bookmarks.size())
    return panels.session.notify(fmt::format("there is no bookmark {}; B makes one", digit + 1));
  panels.perform("go_to", {{"name", std::next(bookmarks.begin(), static_cast<std::ptrdiff_t>(digit))->first}});
}

// Returns "name", or the first of "name 2", "name 3", ... that is not taken.
template <class IsTaken>
std::string free_name(const std::string& stem, const IsTaken& is_taken) {
  for (int i = 1;; ++i)
    if (const std::string name = fmt::format("{} {}", stem, i); !is_taken(name)) return name;
}

void press_record(Panels& panels) {
  const State& state = panels.session.state();
  if (!state.recording.path.empty())
    panels.perform("stop");
  else
    panels.perform("record", {{"name", free_name("path", [&](const auto& n) { return state.paths.contains(n); })}});
}

void press_play(Panels& panels) {
  const State& state = panels.session.state();
  if (!state.playback.path.empty())
    panels.perform("stop");
  else if (!state.paths.empty())
    panels.perform("play", {{"name", state.paths.begin()->first}});
  else
    panels.session.notify("there is no camera path to play; R records one");
}

void take_screenshot(Panels& panels, bool with_panels) {
  const std::string name =
      free_name("occlod-view", [](const std::string& n) { return std::filesystem::exists(n + ".png"); });
  panels.perform("screenshot", {{"file", name + ".png"}, {"panels", with_panels}});
  panels.session.notify("wrote " + name + ".png");
}

// Shows twice or half as much: a budget of triangles, or the tolerance of an HLOD.
void scale_detail(Panels& panels, double factor) {
  const Settings& settings = panels.session.state().settings;
  switch (shown_in(panels.session)) {
    case Shown::hlods: {
      constexpr double least_px = 1.0 / 64.0;
      return set(panels, "hlod_tolerance",
                 std::clamp(std::max(settings.hlod.traverse.tolerance_px, least_px) / factor, least_px, 64.0));
    }
    case Shown::cells:
      return panels.session.notify(
          "+ and - do nothing with view cells, which have the triangles that they were built with; switch Walk off, or "
          "split the screen (T), to refine");
    case Shown::meshes:
    case Shown::cells_beside_meshes:
      return set(panels, "budget",
                 std::round(std::clamp(static_cast<double>(settings.refine.budget) * factor, 1e3, 1e7)));
  }
}

// Closes the dialogue in front. Returns false if there is none.
bool close_dialogue(Panels& panels) {
  if (std::exchange(panels.fields.opens, false)) return true;
  if (!panels.session.state().settings.window.help) return false;
  set(panels, "help", false);
  return true;
}

}  // namespace

void press_key(Panels& panels, int key, int mods) {
  if (key == GLFW_KEY_ESCAPE && close_dialogue(panels)) return;
  if (panels.takes_keys()) return;
  const bool control = (mods & GLFW_MOD_CONTROL) != 0;
  for (const KeyBinding& binding : key_bindings())
    if (binding.key == key && ((binding.mods & GLFW_MOD_CONTROL) != 0) == control) {
      const nlohmann::json& action = action_of(binding, shown_in(panels.session));
      return action.is_string() ? panels.session.notify(action.get<std::string>()) : panels.session.perform(action);
    }
  if (key >= GLFW_KEY_1 && key <= GLFW_KEY_9) return press_digit(panels, static_cast<std::size_t>(key - GLFW_KEY_1));
  const State& state = panels.session.state();
  switch (key) {
    case GLFW_KEY_B:
      return panels.perform("bookmark",
                            {{"name", free_name("view", [&](const auto& n) { return state.bookmarks.contains(n); })}});
    case GLFW_KEY_R:
      return press_record(panels);
    case GLFW_KEY_SPACE:
      return press_play(panels);
    case GLFW_KEY_P:
      return take_screenshot(panels, (mods & GLFW_MOD_SHIFT) != 0);
    case GLFW_KEY_EQUAL:
    case GLFW_KEY_KP_ADD:
      return scale_detail(panels, 2.0);
    case GLFW_KEY_MINUS:
    case GLFW_KEY_KP_SUBTRACT:
      return scale_detail(panels, 0.5);
    case GLFW_KEY_O:
      if (control) panels.fields.opens = true;
      return;
    case GLFW_KEY_S:
      if (control) panels.perform("save_scene", {{"file", panels.fields.save_scene}});
      return;
    default:
      return;
  }
}

}  // namespace occlod::viewer
