// Draws the sections of the sidebar that consist of settings only.
#include <string_view>
#include <vector>

#include "controls.h"
#include "panels.h"

namespace occlod::viewer {
namespace {

// Returns those that draw_first() does not draw.
std::vector<Setting> later_settings(std::span<const Setting> settings) {
  std::vector<Setting> later;
  for (const Setting& setting : settings) {
    const std::string_view name = setting.name;
    if (name != "budget" && name != "occlusion" && name != "freeze" && name != "compare") later.push_back(setting);
  }
  return later;
}

// Draws them in order, two switches per row.
void draw_settings(Panels& panels, std::span<const Setting> settings) {
  bool beside = false;
  for (const Setting& setting : settings) {
    const bool toggle = setting.kind == Setting::Kind::toggle;
    if (toggle && beside) ImGui::SameLine(ImGui::GetWindowContentRegionMax().x * 0.5F);
    draw_setting(panels, setting);
    beside = toggle && !beside;
  }
}

}  // namespace

void draw_refinement(Panels& panels) {
  if (!begin_section(panels, "Refinement", false)) return;
  draw_settings(panels, later_settings(refine_settings()));
  if (!panels.session.state().settings.compare) draw_setting(panels, "beside");
}

void draw_look(Panels& panels) {
  if (!begin_section(panels, "Look", false)) return;
  if (!are_hlods(*panels.session.state().objects)) return draw_settings(panels, look_settings());
  // The others concern meshes.
  std::vector<Setting> settings;
  for (const Setting& setting : look_settings())
    for (const char* name : {"shading", "wire", "back_faces", "antialias", "legend", "bounds", "birdseye"})
      if (setting.name == std::string_view(name)) settings.push_back(setting);
  draw_settings(panels, settings);
}

void draw_window_settings(Panels& panels) {
  if (!begin_section(panels, "Window", false)) return;
  draw_settings(panels, window_settings());
  draw_label("Size");
  for (const auto& [label, width, height] :
       {std::tuple("1280 x 800", 1280, 800), std::tuple("1920 x 1080", 1920, 1080)}) {
    draw_button(panels, "window_size", {{"width", width}, {"height", height}}, label);
    ImGui::SameLine();
  }
  ImGui::NewLine();
  draw_button(panels, "reset");
  ImGui::SameLine();
  draw_button(panels, "quit");
}

}  // namespace occlod::viewer
