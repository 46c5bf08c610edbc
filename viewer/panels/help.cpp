// Shows keys and mouse on F1.
#include <algorithm>
#include <array>

#include "keys.h"
#include "panels.h"
#include "theme.h"

namespace occlod::viewer {
namespace {

struct Line {
  const char* keys;
  const char* what;
};
constexpr std::array<Line, 17> mouse = {{{"left drag", "orbit; look around when flying or walking"},
                                         {"right or middle drag", "pan, also Shift + left drag"},
                                         {"wheel", "zoom to the cursor; speed when flying or walking"},
                                         {"click", "pick a triangle, its split and its object"},
                                         {"double click", "make the point under the cursor the target"},
                                         {"Ctrl + drag", "move the object under the cursor"},
                                         {"drop a file", "add it to what is open"},
                                         {"W A S D, Q E", "fly or walk, down and up; with Shift four times as fast"},
                                         {"1 to 9", "go to a bookmark"},
                                         {"B", "bookmark this view"},
                                         {"Space", "play the first camera path, or stop it"},
                                         {"R", "start or stop recording a camera path"},
                                         {"P", "screenshot; Shift + P includes the panels"},
                                         {"+ -", "double or halve the budget; halve or double an HLOD's tolerance"},
                                         {"Ctrl + O", "open"},
                                         {"Ctrl + S", "save the scene"},
                                         {"Ctrl + click", "type the value of a slider"}}};

constexpr float widest_ems = 68.0F;

void draw_cells(const char* keys, const char* what) {
  ImGui::TableNextColumn();
  ImGui::TextColored(accent_color(), "%s", keys);
  ImGui::TableNextColumn();
  ImGui::TextWrapped("%s", what);
}

}  // namespace

void draw_help(Panels& panels) {
  if (!panels.session.state().settings.window.help) return;
  bool open = true;
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(whole.x / 2.0F, whole.y / 2.0F), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  ImGui::SetNextWindowSize(ImVec2(std::min(widest_ems * ImGui::GetFontSize(), 0.96F * whole.x), 0.0F));
  ImGui::Begin("Keys and mouse", &open,
               ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
  const std::vector<KeyBinding>& bindings = key_bindings();
  if (ImGui::BeginTable("help", 4, ImGuiTableFlags_SizingFixedFit)) {
    for (const bool text : {false, true, false, true})
      ImGui::TableSetupColumn("", text ? ImGuiTableColumnFlags_WidthStretch : ImGuiTableColumnFlags_WidthFixed);
    for (std::size_t i = 0; i < std::max(mouse.size(), bindings.size()); ++i) {
      ImGui::TableNextRow();
      const Line& line = i < mouse.size() ? mouse[i] : Line{"", ""};
      draw_cells(line.keys, line.what);
      if (i < bindings.size()) draw_cells(bindings[i].keys, bindings[i].what);
    }
    ImGui::EndTable();
  }
  ImGui::End();
  if (!open) panels.perform("set", {{"setting", "help"}, {"value", false}});
}

}  // namespace occlod::viewer
