// Shows where the camera is and how it moves.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <string>

#include "command.h"
#include "controls.h"
#include "panels.h"

namespace occlod::viewer {
namespace {

void draw_sides(Panels& panels) {
  const float width = (ImGui::GetContentRegionAvail().x - 2.0F * ImGui::GetStyle().ItemSpacing.x) / 3.0F;
  int i = 0;
  for (const auto& [side, label] :
       {std::pair("front", "Front"), std::pair("right", "Right"), std::pair("top", "Top"), std::pair("back", "Back"),
        std::pair("left", "Left"), std::pair("bottom", "Bottom")}) {
    if (i++ % 3 != 0) ImGui::SameLine();
    draw_button(panels, "view_from", {{"side", side}}, label, width);
  }
  draw_button(panels, "frame_all", nlohmann::json::object(), nullptr, width);
  ImGui::SameLine();
  draw_button(panels, "turn_up", {{"axis", "y"}}, "Y up", width);
  ImGui::SameLine();
  draw_button(panels, "turn_up", {{"axis", "z"}}, "Z up", width);
}

void draw_bookmarks(Panels& panels) {
  draw_button(panels, "bookmark", {{"name", panels.fields.bookmark}});
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::InputText("##name", &panels.fields.bookmark);
  const auto bookmarks = panels.session.state().bookmarks;  // a copy, because actions change it
  for (const auto& [name, camera] : bookmarks) {
    ImGui::PushID(name.c_str());
    draw_button(panels, "go_to", {{"name", name}}, name.c_str(), ImGui::GetContentRegionAvail().x * 0.7F);
    ImGui::SameLine();
    draw_button(panels, "forget", {{"name", name}}, nullptr, -1.0F);
    ImGui::PopID();
  }
}

// Draws the angle of a perspective camera, or the height of an orthographic one.
void draw_lens(Panels& panels, const Camera& camera) {
  bool on = camera.orthographic_height.has_value();
  panels.drawn.insert("orthographic");
  const Command& command = *find_command("orthographic");
  if (ImGui::Checkbox(command.label, &on)) panels.perform("orthographic", {{"on", on}});
  draw_help_of_item(command.help);
  draw_label(camera.orthographic_height ? "Height" : "Angle");
  if (camera.orthographic_height) {
    const double radius = bounds_of(*panels.session.state().objects).radius, least = 1e-4 * radius,
                 most = 10.0 * radius;
    double height = *camera.orthographic_height;
    if (ImGui::SliderScalar("##height", ImGuiDataType_Double, &height, &least, &most, "%.4g",
                            ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic))
      panels.perform("camera", {{"orthographic_height", height}});
    return;
  }
  double angle = camera.fov_y_deg;
  const double least = 5.0, most = 120.0;
  if (ImGui::SliderScalar("##angle", ImGuiDataType_Double, &angle, &least, &most, "%.1f degrees",
                          ImGuiSliderFlags_AlwaysClamp))
    panels.perform("camera", {{"fov_y_deg", angle}});
}

void draw_picture_size(Panels& panels) {
  draw_label("Picture");
  const State& state = panels.session.state();
  std::string shown = std::to_string(state.camera.width) + " x " + std::to_string(state.camera.height);
  if (!state.fixed_size) shown += ", the window's";
  panels.drawn.insert("picture_size");
  if (!ImGui::BeginCombo("##size", shown.c_str())) return;
  if (ImGui::Selectable("the window's")) panels.perform("picture_size");
  for (const auto& [width, height] : {std::pair(640, 480), std::pair(1024, 768), std::pair(1920, 1080)})
    if (ImGui::Selectable((std::to_string(width) + " x " + std::to_string(height)).c_str()))
      panels.perform("picture_size", {{"width", width}, {"height", height}});
  ImGui::EndCombo();
}

}  // namespace

void draw_camera(Panels& panels) {
  if (!begin_section(panels, "Camera", false)) return;
  for (const Setting& setting : camera_settings())
    if (std::string(setting.name) != "playback_rate") draw_setting(panels, setting);
  draw_sides(panels);
  draw_button(panels, "to_frozen", nlohmann::json::object(), nullptr, -1.0F);
  panels.drawn.insert("camera");
  const Camera camera = panels.session.state().camera;
  const double speed = 0.002 * bounds_of(*panels.session.state().objects).radius;
  if (glm::dvec3 eye = camera.eye; draw_vector("Eye", eye, speed)) panels.perform("camera", {{"eye", as_json(eye)}});
  if (glm::dvec3 target = camera.target; draw_vector("Target", target, speed))
    panels.perform("camera", {{"target", as_json(target)}});
  draw_lens(panels, camera);
  draw_picture_size(panels);
  draw_bookmarks(panels);
}

}  // namespace occlod::viewer
