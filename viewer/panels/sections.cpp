// The sections of the sidebar that are made of settings alone.
#include "controls.h"
#include "panels.h"

namespace occlod::viewer {

void draw_refinement(Panels& panels) {
  if (!begin_section(panels, "Refinement")) return;
  for (const Setting& setting : refine_settings()) draw_setting(panels, setting);
}

void draw_look(Panels& panels) {
  if (!begin_section(panels, "Look")) return;
  for (const Setting& setting : look_settings()) draw_setting(panels, setting);
}

void draw_window_settings(Panels& panels) {
  if (!begin_section(panels, "Window", false)) return;
  for (const Setting& setting : window_settings()) draw_setting(panels, setting);
  ImGui::AlignTextToFramePadding();
  draw_label(panels, "Size");
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
