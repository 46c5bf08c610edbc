// Draws the controls of camera paths.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "controls.h"
#include "panels.h"

namespace occlod::viewer {
namespace {

void draw_path(Panels& panels, const std::string& name, const CameraPath& path) {
  ImGui::PushID(name.c_str());
  const Playback& playback = panels.session.state().playback;
  int frame = playback.path == name ? static_cast<int>(playback.at) : 0;
  ImGui::AlignTextToFramePadding();
  ImGui::Text("%s, %d frames", name.c_str(), path.frames);
  ImGui::SetNextItemWidth(-1.0F);
  panels.drawn.insert("seek");
  if (ImGui::SliderInt("##frame", &frame, 0, path.frames - 1, "frame %d"))
    panels.perform("seek", {{"name", name}, {"frame", frame}});
  draw_button(panels, "play", {{"name", name}});
  ImGui::SameLine();
  draw_button(panels, "picture_sequence", {{"name", name}, {"folder", panels.fields.pictures}});
  ImGui::SameLine();
  draw_button(panels, "delete_path", {{"name", name}}, "Delete");
  ImGui::PopID();
}

}  // namespace

void draw_paths(Panels& panels) {
  if (!begin_section(panels, "Camera paths", false)) return;
  const State& state = panels.session.state();
  if (state.recording.path.empty() && state.playback.path.empty()) {
    draw_button(panels, "record", {{"name", panels.fields.path}});
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0F);
    ImGui::InputText("##name", &panels.fields.path);
  } else {
    draw_button(panels, "stop");
    ImGui::SameLine();
    ImGui::TextUnformatted(state.recording.path.empty()
                               ? fmt::format("playing {}", state.playback.path).c_str()
                               : fmt::format("recording, {} keys", state.recording.keys.keys.size()).c_str());
  }
  draw_button(panels, "turntable", {{"name", panels.fields.path}});
  draw_setting(panels, "playback_rate");
  draw_label("Pictures to");
  ImGui::InputText("##folder", &panels.fields.pictures);
  const auto paths = state.paths;  // a copy, because actions change it
  for (const auto& [name, path] : paths) draw_path(panels, name, path);
}

}  // namespace occlod::viewer
