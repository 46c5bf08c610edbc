// Shows what can be opened while nothing is: files, and scenes that need none.
#include <algorithm>

#include "controls.h"
#include "examples.h"
#include "panels.h"

namespace occlod::viewer {
namespace {

constexpr ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize |
                                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoBringToFrontOnFocus;

void draw_example(Panels& panels, const Example& example, float width) {
  draw_button(panels, "open_example", {{"name", example.name}}, example.label, width);
  ImGui::SameLine();
  ImGui::TextWrapped("%s", example.about);
}

}  // namespace

void draw_start(Panels& panels, const Layout& layout) {
  if (!panels.session.state().objects->empty() || panels.session.loader().busy()) return;
  const float margin = 16.0F * panels.scale;
  const float width = std::min(560.0F * panels.scale, layout.view.width() - 2.0F * margin);
  if (width < 200.0F * panels.scale) return;
  const ImVec2 middle((layout.view.low.x + layout.view.high.x) / 2.0F, (layout.view.low.y + layout.view.high.y) / 2.0F);
  ImGui::SetNextWindowPos(middle, ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0.0F), ImVec2(width, layout.view.height()));
  ImGui::SetNextWindowBgAlpha(0.95F);
  ImGui::Begin("start", nullptr, flags);
  const float column = 130.0F * panels.scale;
  if (ImGui::Button("Open...##start", ImVec2(column, 0.0F))) panels.fields.opens = true;
  ImGui::SameLine();
  ImGui::TextWrapped("a mesh, a hierarchy, an HLOD or a scene, or drop it here");
  ImGui::Separator();
  ImGui::TextUnformatted("Open an example");
  for (const Example& example : examples()) draw_example(panels, example, column);
  ImGui::Separator();
  ImGui::TextDisabled("F1 lists keys and mouse actions");
  ImGui::End();
}

}  // namespace occlod::viewer
