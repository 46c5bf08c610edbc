// Draws the controls for opening and saving.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "controls.h"
#include "panels.h"

namespace occlod::viewer {
namespace {

struct Folder {
  std::vector<std::filesystem::path> folders;
  std::vector<std::filesystem::path> files;
};

Folder list(const std::filesystem::path& folder) {
  Folder result;
  std::error_code failed;
  for (std::filesystem::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
    std::error_code ignored;
    if (at->path().filename().string().starts_with('.')) continue;
    if (at->is_directory(ignored))
      result.folders.push_back(at->path());
    else if (can_be_opened(at->path()))
      result.files.push_back(at->path());
  }
  std::sort(result.folders.begin(), result.folders.end());
  std::sort(result.files.begin(), result.files.end());
  return result;
}

void open(Panels& panels, const std::filesystem::path& file) {
  panels.perform("open", {{"file", file.string()}});
  panels.fields.opens = false;
}

void draw_folder(Panels& panels) {
  std::string& folder = panels.fields.open_folder;
  const Folder content = list(folder);
  const std::filesystem::path parent = std::filesystem::path(folder).parent_path();
  if (ImGui::Selectable("..")) folder = parent.string();
  for (const std::filesystem::path& path : content.folders)
    if (ImGui::Selectable((path.filename().string() + "/").c_str())) folder = path.string();
  for (const std::filesystem::path& path : content.files)
    if (ImGui::Selectable(path.filename().string().c_str())) open(panels, path);
}

}  // namespace

void draw_files(Panels& panels) {
  const float third = (ImGui::GetContentRegionAvail().x - 2.0F * ImGui::GetStyle().ItemSpacing.x) / 3.0F;
  panels.drawn.insert("open");
  if (ImGui::Button("Open...", ImVec2(third, 0.0F))) panels.fields.opens = true;
  draw_help_of_item(
      "Open a mesh, a hierarchy (.olod), an HLOD (.ohlod), a scene (.json) or its view cells (.vlod). Files can also "
      "be "
      "dropped on the window");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(third);
  if (ImGui::BeginCombo("##recent", "Recent")) {
    const auto recent = panels.session.state().recent;  // a copy, because opening changes it
    for (const std::filesystem::path& file : recent)
      if (ImGui::Selectable(file.filename().string().c_str())) open(panels, file);
    ImGui::Separator();
    if (ImGui::Selectable("Clear the list")) panels.perform("forget_recent");
    ImGui::EndCombo();
  }
  panels.drawn.insert("forget_recent");
  ImGui::SameLine();
  draw_button(panels, "close_all", nlohmann::json::object(), nullptr, third);
}

void draw_output(Panels& panels) {
  if (!begin_section(panels, "Files", false)) return;
  const float third = (ImGui::GetContentRegionAvail().x - 2.0F * ImGui::GetStyle().ItemSpacing.x) / 3.0F;
  draw_setting(panels, "open_as");
  draw_button(panels, "save_scene", {{"file", panels.fields.save_scene}}, nullptr, third);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::InputText("##scene", &panels.fields.save_scene);
  draw_button(panels, "screenshot", {{"file", panels.fields.screenshot}}, nullptr, third);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::InputText("##screenshot", &panels.fields.screenshot);
  draw_button(panels, "export_mesh", {{"file", panels.fields.mesh}}, nullptr, third);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::InputText("##mesh", &panels.fields.mesh);
}

namespace {

// Draws the field for the path of a file. It has the focus when the dialogue appears, and gets it back when something
// is typed. Returns true when Enter is pressed.
bool draw_path_field(Fields& fields) {
  // Dear ImGui takes no characters before the picture after the one in which a field gets the focus, so they wait.
  ImVector<ImWchar>& typed = ImGui::GetIO().InputQueueCharacters;
  if (fields.types_path || !ImGui::IsAnyItemActive()) {
    for (const ImWchar c : typed) fields.typed_early.push_back(c);
    typed.clear();
    if (fields.types_path) typed.swap(fields.typed_early);
    if (ImGui::IsWindowAppearing() || !fields.typed_early.empty()) ImGui::SetKeyboardFocusHere();
  }
  const bool entered = ImGui::InputTextWithHint("##file", "or type the path of a file", &fields.open_file,
                                                ImGuiInputTextFlags_EnterReturnsTrue);
  fields.types_path = ImGui::IsItemActive();
  return entered;
}

}  // namespace

void draw_open_dialogue(Panels& panels, const Layout& layout) {
  Fields& fields = panels.fields;
  if (fields.opens && !ImGui::IsPopupOpen("Open")) {
    ImGui::OpenPopup("Open");
    fields.open_file.clear();
    fields.types_path = false;
  }
  if (fields.open_folder.empty()) fields.open_folder = std::filesystem::current_path().string();
  const ImVec2 middle((layout.view.low.x + layout.view.high.x) / 2.0F, (layout.view.low.y + layout.view.high.y) / 2.0F);
  ImGui::SetNextWindowPos(middle, ImGuiCond_Appearing, ImVec2(0.5F, 0.5F));
  ImGui::SetNextWindowSize(ImVec2(520.0F * panels.scale, 420.0F * panels.scale), ImGuiCond_Appearing);
  if (!ImGui::BeginPopupModal("Open", &fields.opens, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings))
    return;
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::InputText("##folder", &fields.open_folder);
  const float line = ImGui::GetFrameHeightWithSpacing();
  ImGui::BeginChild("content", ImVec2(0.0F, -line), true);
  draw_folder(panels);
  ImGui::EndChild();
  ImGui::SetNextItemWidth(-80.0F * panels.scale);
  const bool entered = draw_path_field(fields);
  ImGui::SameLine();
  if ((ImGui::Button("Open", ImVec2(-1.0F, 0.0F)) || entered) && !fields.open_file.empty())
    open(panels, fields.open_file);
  ImGui::EndPopup();
}

}  // namespace occlod::viewer
