#include "theme.h"

#include <imgui.h>

#include <cmath>
#include <filesystem>

namespace occlod::viewer {
namespace {

constexpr float font_px = 15.0F;

// Finds a sans-serif font of the usual systems. Without one, the built-in font of fixed width is used.
const char* find_font() {
  constexpr const char* candidates[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                        "/usr/share/fonts/TTF/DejaVuSans.ttf",
                                        "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                                        "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
                                        "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf"};
  std::error_code ignored;
  for (const char* candidate : candidates)
    if (std::filesystem::exists(candidate, ignored)) return candidate;
  return nullptr;
}

void load_font(float scale) {
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  fonts.Clear();
  const float size = std::round(font_px * scale);
  static const ImWchar glyphs[] = {0x0020, 0x00FF, 0x2010, 0x2026, 0x2190, 0x2193, 0};
  const char* file = find_font();
  if (file != nullptr && fonts.AddFontFromFileTTF(file, size, nullptr, glyphs) != nullptr) return;
  ImFontConfig config;
  config.SizePixels = size;
  fonts.AddFontDefault(&config);
}

void color(ImGuiCol which, float r, float g, float b, float alpha = 1.0F) {
  ImGui::GetStyle().Colors[which] = ImVec4(r, g, b, alpha);
}

void set_light_surfaces() {
  color(ImGuiCol_Text, 0.10F, 0.11F, 0.13F);
  color(ImGuiCol_TextDisabled, 0.38F, 0.41F, 0.45F);
  color(ImGuiCol_WindowBg, 0.945F, 0.950F, 0.955F, 0.98F);
  color(ImGuiCol_PopupBg, 0.985F, 0.985F, 0.990F, 0.98F);
  color(ImGuiCol_Border, 0.74F, 0.76F, 0.79F);
  color(ImGuiCol_FrameBg, 0.865F, 0.875F, 0.890F);
  color(ImGuiCol_FrameBgHovered, 0.820F, 0.835F, 0.855F);
  color(ImGuiCol_FrameBgActive, 0.780F, 0.800F, 0.825F);
  color(ImGuiCol_TitleBg, 0.890F, 0.900F, 0.915F);
  color(ImGuiCol_TitleBgActive, 0.850F, 0.865F, 0.885F);
  color(ImGuiCol_ScrollbarBg, 0.0F, 0.0F, 0.0F, 0.0F);
  color(ImGuiCol_Separator, 0.74F, 0.76F, 0.79F);
  color(ImGuiCol_CheckMark, 0.72F, 0.42F, 0.05F);
  color(ImGuiCol_SliderGrab, 0.80F, 0.50F, 0.12F, 0.50F);  // the value shows through
  color(ImGuiCol_SliderGrabActive, 0.80F, 0.50F, 0.12F, 0.70F);
  color(ImGuiCol_Button, 0.815F, 0.830F, 0.850F);
  color(ImGuiCol_ButtonHovered, 0.760F, 0.780F, 0.810F);
  color(ImGuiCol_ButtonActive, 0.700F, 0.725F, 0.760F);
  color(ImGuiCol_Header, 0.865F, 0.880F, 0.900F);
  color(ImGuiCol_HeaderHovered, 0.815F, 0.835F, 0.860F);
  color(ImGuiCol_HeaderActive, 0.770F, 0.795F, 0.825F);
  color(ImGuiCol_PlotHistogram, 0.80F, 0.50F, 0.12F);
}

bool is_light() { return ImGui::GetStyle().Colors[ImGuiCol_WindowBg].x > 0.5F; }

void set_surfaces() {
  color(ImGuiCol_Text, 0.88F, 0.90F, 0.92F);
  color(ImGuiCol_TextDisabled, 0.56F, 0.60F, 0.65F);
  color(ImGuiCol_WindowBg, 0.125F, 0.140F, 0.160F, 0.98F);
  color(ImGuiCol_PopupBg, 0.150F, 0.165F, 0.190F, 0.98F);
  color(ImGuiCol_Border, 0.25F, 0.28F, 0.32F);
  color(ImGuiCol_FrameBg, 0.190F, 0.210F, 0.240F);
  color(ImGuiCol_FrameBgHovered, 0.235F, 0.260F, 0.300F);
  color(ImGuiCol_FrameBgActive, 0.270F, 0.300F, 0.345F);
  color(ImGuiCol_TitleBg, 0.150F, 0.165F, 0.190F);
  color(ImGuiCol_TitleBgActive, 0.170F, 0.190F, 0.220F);
  color(ImGuiCol_ScrollbarBg, 0.0F, 0.0F, 0.0F, 0.0F);
  color(ImGuiCol_Separator, 0.25F, 0.28F, 0.32F);
  color(ImGuiCol_ModalWindowDimBg, 0.0F, 0.0F, 0.0F, 0.4F);
}

void set_accents() {
  color(ImGuiCol_CheckMark, 0.93F, 0.68F, 0.36F);
  color(ImGuiCol_SliderGrab, 0.93F, 0.68F, 0.36F, 0.45F);  // the value shows through
  color(ImGuiCol_SliderGrabActive, 0.93F, 0.68F, 0.36F, 0.65F);
  color(ImGuiCol_Button, 0.225F, 0.255F, 0.295F);
  color(ImGuiCol_ButtonHovered, 0.290F, 0.330F, 0.385F);
  color(ImGuiCol_ButtonActive, 0.340F, 0.385F, 0.450F);
  color(ImGuiCol_Header, 0.175F, 0.200F, 0.235F);
  color(ImGuiCol_HeaderHovered, 0.225F, 0.260F, 0.305F);
  color(ImGuiCol_HeaderActive, 0.260F, 0.300F, 0.350F);
  color(ImGuiCol_PlotHistogram, 0.93F, 0.68F, 0.36F);
}

}  // namespace

ImVec4 accent_color() { return is_light() ? ImVec4(0.62F, 0.34F, 0.02F, 1.0F) : ImVec4(0.93F, 0.68F, 0.36F, 1.0F); }

ImVec4 error_color_of_text() {
  return is_light() ? ImVec4(0.72F, 0.10F, 0.06F, 1.0F) : ImVec4(0.95F, 0.55F, 0.48F, 1.0F);
}

void apply_theme(float scale, Theme theme) {
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  if (theme == Theme::light) {
    ImGui::StyleColorsLight();
    set_light_surfaces();
  } else {
    ImGui::StyleColorsDark();
    set_surfaces();
    set_accents();
  }
  style.WindowRounding = 0.0F;
  style.FrameRounding = 3.0F;
  style.GrabRounding = 3.0F;
  style.PopupRounding = 4.0F;
  style.WindowBorderSize = 0.0F;
  style.WindowPadding = ImVec2(10.0F, 8.0F);
  style.FramePadding = ImVec2(6.0F, 3.0F);
  style.ItemSpacing = ImVec2(6.0F, 5.0F);
  style.ScrollbarSize = 11.0F;
  style.ScaleAllSizes(scale);
  load_font(scale);
}

}  // namespace occlod::viewer
