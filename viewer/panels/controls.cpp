#include "controls.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "command.h"

namespace occlod::viewer {
namespace {

constexpr float label_share = 0.42F;  // of a panel's width

void set(Panels& panels, const Setting& setting, const nlohmann::json& value) {
  panels.perform("set", {{"setting", setting.name}, {"value", value}});
}

void draw_toggle(Panels& panels, const Setting& setting, const nlohmann::json& value) {
  bool on = value.get<bool>();
  if (ImGui::Checkbox(setting.label, &on)) set(panels, setting, on);
}

void draw_choice(Panels& panels, const Setting& setting, const nlohmann::json& value) {
  if (!ImGui::BeginCombo("##value", value.get<std::string>().c_str())) return;
  for (const char* choice : setting.choices)
    if (ImGui::Selectable(choice, value == choice)) set(panels, setting, choice);
  ImGui::EndCombo();
}

void draw_integer(Panels& panels, const Setting& setting, const nlohmann::json& value) {
  auto number = value.get<std::int64_t>();
  const auto least = static_cast<std::int64_t>(setting.least);
  const auto most = static_cast<std::int64_t>(setting.most);
  const ImGuiSliderFlags flags =
      ImGuiSliderFlags_AlwaysClamp | (setting.logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None);
  if (ImGui::SliderScalar("##value", ImGuiDataType_S64, &number, &least, &most, "%lld", flags))
    set(panels, setting, number);
}

void draw_number(Panels& panels, const Setting& setting, const nlohmann::json& value) {
  auto number = value.get<double>();
  const std::string format = fmt::format("%.2f {}", setting.unit);
  const ImGuiSliderFlags flags =
      ImGuiSliderFlags_AlwaysClamp | (setting.logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None);
  if (ImGui::SliderScalar("##value", ImGuiDataType_Double, &number, &setting.least, &setting.most, format.c_str(),
                          flags))
    set(panels, setting, number);
}

// Parses text like "300, 2500" into an array; stops at what is not a number.
nlohmann::json parse_integers(const std::string& text) {
  nlohmann::json values = nlohmann::json::array();
  const char* at = text.c_str();
  while (true) {
    char* end = nullptr;
    const std::uint64_t value = std::strtoull(at, &end, 10);
    if (end == at) return values;
    values.push_back(value);
    at = end + std::strspn(end, ", ");
  }
}

// The text is used when Enter is pressed.
void draw_integers(Panels& panels, const Setting& setting, const nlohmann::json& value) {
  std::string text = fmt::format("{}", fmt::join(value.get<std::vector<std::uint32_t>>(), ", "));
  if (ImGui::InputText("##value", &text, ImGuiInputTextFlags_EnterReturnsTrue))
    set(panels, setting, parse_integers(text));
}

}  // namespace

void draw_label(const char* text, const char* help) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(text);
  if (help != nullptr) draw_help_of_item(help);
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x * label_share);
  ImGui::SetNextItemWidth(-1.0F);
}

void draw_row(const char* name, const std::string& value, float column) {
  ImGui::TextDisabled("%s", name);
  ImGui::SameLine();
  ImGui::SetCursorPosX(std::max(ImGui::GetCursorPosX(), ImGui::GetWindowContentRegionMax().x * column));
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(value.c_str());
  ImGui::PopTextWrapPos();
}

bool draw_vector(const char* label, glm::dvec3& value, double speed) {
  // What is dragged is rounded to what is shown: far from 0 that takes more digits than three.
  const double largest = std::max({std::abs(value.x), std::abs(value.y), std::abs(value.z), speed});
  const int digits = std::clamp(static_cast<int>(std::ceil(std::log10(largest / speed))), 3, 15);
  draw_label(label);
  ImGui::PushID(label);
  const bool changed = ImGui::DragScalarN("##value", ImGuiDataType_Double, &value.x, 3, static_cast<float>(speed),
                                          nullptr, nullptr, fmt::format("%.{}g", digits).c_str());
  ImGui::PopID();
  return changed;
}

nlohmann::json as_json(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

void draw_help_of_item(const char* text) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22.0F);
  ImGui::TextUnformatted(text);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void draw_setting(Panels& panels, const Setting& setting) {
  const nlohmann::json value = setting.get(panels.session.state().settings);
  ImGui::PushID(setting.name);
  if (setting.kind != Setting::Kind::toggle) draw_label(setting.label, setting.help);
  switch (setting.kind) {
    case Setting::Kind::toggle:
      draw_toggle(panels, setting, value);
      break;
    case Setting::Kind::choice:
      draw_choice(panels, setting, value);
      break;
    case Setting::Kind::integer:
      draw_integer(panels, setting, value);
      break;
    case Setting::Kind::number:
      draw_number(panels, setting, value);
      break;
    case Setting::Kind::integers:
      draw_integers(panels, setting, value);
      break;
  }
  draw_help_of_item(setting.help);
  ImGui::PopID();
  panels.drawn.insert({setting.name, "set"});
}

void draw_setting(Panels& panels, const char* name) {
  const Setting* setting = find_setting(name);
  assert(setting != nullptr);
  draw_setting(panels, *setting);
}

bool draw_button(Panels& panels, const char* command, const nlohmann::json& arguments, const char* label, float width) {
  const Command* found = find_command(command);
  assert(found != nullptr);
  panels.drawn.insert(command);
  const float used = width < 0.0F ? ImGui::GetContentRegionAvail().x : width;
  const bool pressed = ImGui::Button(label != nullptr ? label : found->label, ImVec2(used, 0.0F));
  draw_help_of_item(found->help);
  if (pressed) panels.perform(command, arguments);
  return pressed;
}

std::string grouped(double number) {
  std::string digits = fmt::format("{:.0f}", number);
  for (auto place = static_cast<std::ptrdiff_t>(digits.size()) - 3; place > 0; place -= 3)
    digits.insert(static_cast<std::size_t>(place), ",");
  return digits;
}

bool begin_section(Panels& panels, const char* title, bool open) {
  if (panels.unfold) ImGui::SetNextItemOpen(true);
  return ImGui::CollapsingHeader(title, open ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None);
}

}  // namespace occlod::viewer
