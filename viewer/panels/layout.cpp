// Lays out all panels, and draws them together.
#include <algorithm>
#include <cmath>

#include "panels.h"

namespace occlod::viewer {
namespace {

constexpr float sidebar_width = 330.0F;
constexpr float graph_height = 150.0F;

// Returns the largest rectangle of these proportions in the middle of `area`.
Area fitted(const Area& area, const Camera& camera) {
  const float aspect = static_cast<float>(camera.width) / static_cast<float>(camera.height);
  float width = std::min(area.width(), area.height() * aspect);
  float height = width / aspect;
  // A picture of the area's own size, up to a rounded pixel, fills it.
  if (std::abs(width - area.width()) < 2.0F) width = area.width();
  if (std::abs(height - area.height()) < 2.0F) height = area.height();
  const float x = area.low.x + std::floor((area.width() - width) / 2.0F);
  const float y = area.low.y + std::floor((area.height() - height) / 2.0F);
  return {ImVec2(x, y), ImVec2(x + width, y + height)};
}

constexpr ImGuiWindowFlags fixed = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings |
                                   ImGuiWindowFlags_NoBringToFrontOnFocus;

void begin_fixed(const char* name, const Area& area) {
  ImGui::SetNextWindowPos(area.low);
  ImGui::SetNextWindowSize(ImVec2(area.width(), area.height()));
  ImGui::Begin(name, nullptr, fixed);
}

void draw_sidebar(Panels& panels, const Area& area) {
  begin_fixed("sidebar", area);
  draw_files(panels);
  draw_first(panels);
  draw_objects(panels);
  draw_auto(panels);
  if (!are_hlods(*panels.session.state().objects)) {
    draw_cells(panels);
    draw_refinement(panels);
  }
  if (panels.session.state().objects->empty() || are_hlods(*panels.session.state().objects)) draw_hlod(panels);
  draw_look(panels);
  draw_study(panels);
  draw_camera(panels);
  draw_paths(panels);
  draw_output(panels);
  draw_window_settings(panels);
  ImGui::End();
}

void draw_pictures(const Layout& layout, const std::vector<ImTextureID>& pictures) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddRectFilled(layout.view.low, layout.view.high, ImGui::GetColorU32(ImGuiCol_TitleBg));
  for (std::size_t i = 0; i < layout.pictures.size() && i < pictures.size(); ++i)
    list.AddImage(pictures[i], layout.pictures[i].low, layout.pictures[i].high, ImVec2(0.0F, 1.0F), ImVec2(1.0F, 0.0F));
}

}  // namespace

void Panels::perform(const char* command, nlohmann::json arguments) {
  arguments["do"] = command;
  session.perform(arguments);
}

Layout lay_out(const Session& session, const ImVec2& window, float scale) {
  const State& state = session.state();
  Layout layout;
  const float left = state.settings.window.sidebar ? std::min(sidebar_width * scale, window.x / 2.0F) : 0.0F;
  const float below = state.settings.window.graph ? std::min(graph_height * scale, window.y / 3.0F) : 0.0F;
  layout.sidebar = {ImVec2(0.0F, 0.0F), ImVec2(left, window.y)};
  layout.graph = {ImVec2(left, window.y - below), window};
  layout.view = {ImVec2(left, 0.0F), ImVec2(window.x, window.y - below)};
  if (!state.settings.compare) {
    layout.pictures = {fitted(layout.view, state.camera)};
    return layout;
  }
  const float middle = std::floor((layout.view.low.x + layout.view.high.x) / 2.0F);
  layout.pictures = {fitted({layout.view.low, ImVec2(middle - 1.0F, layout.view.high.y)}, state.camera),
                     fitted({ImVec2(middle + 1.0F, layout.view.low.y), layout.view.high}, state.camera)};
  return layout;
}

void draw_panels(Panels& panels, const Layout& layout, const std::vector<ImTextureID>& pictures) {
  const WindowSettings& window = panels.session.state().settings.window;
  draw_pictures(layout, pictures);
  if (window.sidebar) draw_sidebar(panels, layout.sidebar);
  if (window.graph) {
    begin_fixed("numbers", layout.graph);
    draw_numbers(panels, layout.graph);
    ImGui::End();
  }
  draw_distance(panels.session, layout);
  draw_insets(panels, layout);
  draw_legend(panels, layout);
  draw_selected(panels, layout);
  draw_messages(panels, layout);
  draw_start(panels, layout);
  draw_open_dialogue(panels, layout);
  draw_help(panels);
}

}  // namespace occlod::viewer
