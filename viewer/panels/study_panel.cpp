// Draws what helps to look closely: the clipping plane, and the distance between two points.
#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "controls.h"
#include "occlod/view.h"
#include "panels.h"

namespace occlod::viewer {
namespace {

std::string distance_text(const State& state) {
  return fmt::format("{:.6g}", glm::distance(state.measured[0], state.measured[1]));
}

}  // namespace

void draw_study(Panels& panels) {
  if (!begin_section(panels, "Clip and measure", false)) return;
  for (const char* name : {"clip_axis", "clip_at", "clip_flip", "measuring"}) draw_setting(panels, name);
  const State& state = panels.session.state();
  if (state.measured.size() == 2)
    draw_row("Distance", distance_text(state));
  else if (state.settings.measure)
    ImGui::TextDisabled("Click %s", state.measured.empty() ? "a point of the mesh" : "the other point");
  draw_button(panels, "unmeasure");
}

// Writes the distance beside the middle of its line, where that is in the picture.
void draw_distance(const Session& session, const Layout& layout) {
  const State& state = session.state();
  if (state.measured.size() != 2) return;
  const glm::dvec4 clip =
      View(state.camera).world_to_clip() * glm::dvec4((state.measured[0] + state.measured[1]) / 2.0, 1.0);
  if (!(clip.w > 0.0) || std::abs(clip.x) > clip.w || std::abs(clip.y) > clip.w) return;
  const Area& picture = layout.pictures[0];
  const ImVec2 at(picture.low.x + picture.width() * static_cast<float>(0.5 + 0.5 * clip.x / clip.w),
                  picture.low.y + picture.height() * static_cast<float>(0.5 - 0.5 * clip.y / clip.w));
  const std::string text = distance_text(state);
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float room = 0.4F * ImGui::GetFontSize();
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddRectFilled(ImVec2(at.x + room, at.y + room), ImVec2(at.x + size.x + 3.0F * room, at.y + size.y + 2.0F * room),
                     ImGui::GetColorU32(ImGuiCol_PopupBg), 3.0F);
  list.AddText(ImVec2(at.x + 2.0F * room, at.y + 1.5F * room), ImGui::GetColorU32(ImGuiCol_Text), text.c_str());
}

}  // namespace occlod::viewer
