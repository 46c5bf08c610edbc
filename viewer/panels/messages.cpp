// Shows what is being loaded, and what went wrong.
#include <fmt/format.h>

#include "controls.h"
#include "panels.h"
#include "theme.h"

namespace occlod::viewer {
namespace {

constexpr double notice_s = 6.0;
constexpr double error_s = 30.0;
constexpr ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize |
                                   ImGuiWindowFlags_NoFocusOnAppearing;

void draw_progress(Panels& panels, const LoadProgress& progress) {
  ImGui::TextUnformatted(progress.what.c_str());
  if (progress.waiting > 0) {
    ImGui::SameLine();
    ImGui::TextDisabled("and %d more", progress.waiting);
  }
  ImGui::ProgressBar(static_cast<float>(progress.done), ImVec2(320.0F * panels.scale, 0.0F));
  ImGui::SameLine();
  draw_button(panels, "cancel");
}

bool is_shown(const Notice& notice) {
  return notice.age_s < (notice.is_error || notice.is_warning ? error_s : notice_s);
}

void draw_notice(const Notice& notice, float width) {
  if (notice.is_error) ImGui::PushStyleColor(ImGuiCol_Text, error_color_of_text());
  if (notice.is_warning) ImGui::PushStyleColor(ImGuiCol_Text, accent_color());
  ImGui::PushTextWrapPos(width);
  ImGui::TextUnformatted(notice.text.c_str());
  ImGui::PopTextWrapPos();
  if (notice.is_error || notice.is_warning) ImGui::PopStyleColor();
}

}  // namespace

void draw_messages(Panels& panels, const Layout& layout) {
  const LoadProgress progress = panels.session.loader().progress();
  const auto notices = panels.session.state().notices;  // a copy, because actions change them
  bool any = !progress.what.empty();
  for (const Notice& notice : notices) any = any || is_shown(notice);
  if (!any) return;
  const ImVec2 at((layout.view.low.x + layout.view.high.x) / 2.0F, layout.view.high.y - 14.0F * panels.scale);
  ImGui::SetNextWindowPos(at, ImGuiCond_Always, ImVec2(0.5F, 1.0F));
  ImGui::SetNextWindowBgAlpha(0.95F);
  ImGui::Begin("messages", nullptr, flags);
  if (!progress.what.empty()) draw_progress(panels, progress);
  for (const Notice& notice : notices)
    if (is_shown(notice)) draw_notice(notice, 480.0F * panels.scale);
  if (!notices.empty()) draw_button(panels, "dismiss");
  ImGui::End();
}

}  // namespace occlod::viewer
