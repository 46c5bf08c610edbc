// Draws what is needed first, above the sections that fold: how much is drawn, what hides what, and the two ways to see
// what that does.
#include "controls.h"
#include "panels.h"

namespace occlod::viewer {

void draw_first(Panels& panels) {
  if (are_hlods(*panels.session.state().objects)) {
    draw_setting(panels, "hlod_tolerance");
    draw_setting(panels, "strategy");
  } else {
    draw_setting(panels, "budget");
    draw_setting(panels, "occlusion");
  }
  draw_setting(panels, "freeze");
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x * 0.5F);
  draw_setting(panels, "compare");
  const State& state = panels.session.state();
  if (state.settings.compare) draw_setting(panels, are_hlods(*state.objects) ? "other_strategy" : "beside");
  if (state.settings.freeze) draw_button(panels, "to_frozen", nlohmann::json::object(), nullptr, -1.0F);
}

}  // namespace occlod::viewer
