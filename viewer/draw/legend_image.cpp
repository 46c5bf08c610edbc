#include "draw/legend_image.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <string>

namespace occlod::viewer {
namespace {

// Holds the one picture of all characters, a byte of coverage each pixel.
struct Atlas {
  const ImFont* font = nullptr;
  unsigned char* coverage = nullptr;
  int width = 0;
  int height = 0;
};

Atlas font_atlas() {
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  Atlas atlas{fonts.Fonts[0]};
  fonts.GetTexDataAsAlpha8(&atlas.coverage, &atlas.width, &atlas.height);
  return atlas;
}

// `share` is that of the colour, in [0, 1].
void blend(Image& image, int x, int y, const glm::vec3& color, float share) {
  glm::u8vec4& pixel =
      image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)];
  pixel = {glm::u8vec3(glm::mix(glm::vec3(pixel), color, share) + 0.5F), pixel.w};
}

void fill(Image& image, int left, int top, int width, int height, const glm::vec3& color, float share) {
  for (int y = top; y < top + height; ++y)
    for (int x = left; x < left + width; ++x) blend(image, x, y, color, share);
}

float width_of(const ImFont& font, const std::string& ascii) {
  float width = 0.0F;
  for (const char c : ascii) width += font.FindGlyph(static_cast<ImWchar>(c))->AdvanceX;
  return width;
}

// Copies the characters from the atlas, where they have their size already.
void draw_text(Image& image, const Atlas& atlas, float left, float top, const std::string& ascii,
               const glm::vec3& color) {
  for (const char c : ascii) {
    const ImFontGlyph& glyph = *atlas.font->FindGlyph(static_cast<ImWchar>(c));
    const int x0 = static_cast<int>(std::lround(left + glyph.X0)), y0 = static_cast<int>(std::lround(top + glyph.Y0));
    const int u0 = static_cast<int>(std::lround(glyph.U0 * static_cast<float>(atlas.width)));
    const int v0 = static_cast<int>(std::lround(glyph.V0 * static_cast<float>(atlas.height)));
    const int width = static_cast<int>(std::lround(glyph.U1 * static_cast<float>(atlas.width))) - u0;
    const int height = static_cast<int>(std::lround(glyph.V1 * static_cast<float>(atlas.height))) - v0;
    for (int y = 0; y < height && glyph.Visible; ++y)
      for (int x = 0; x < width; ++x)
        if (const auto covered = atlas.coverage[(v0 + y) * atlas.width + u0 + x]; covered > 0)
          blend(image, x0 + x, y0 + y, color, static_cast<float>(covered) / 255.0F);
    left += glyph.AdvanceX;
  }
}

}  // namespace

bool draw_legend(Image& image, std::span<const LegendEntry> legend, float scale) {
  if (legend.empty()) return true;
  const Atlas atlas = font_atlas();
  const int size = static_cast<int>(std::lround(atlas.font->FontSize));
  const int margin = static_cast<int>(std::lround(10.0F * scale)), gap = size / 3, line = size + gap;
  float text_width = 0.0F;
  for (const LegendEntry& entry : legend) text_width = std::max(text_width, width_of(*atlas.font, entry.text));
  const int width = 4 * gap + size + static_cast<int>(std::ceil(text_width));
  const int height = static_cast<int>(legend.size()) * line + 3 * gap;
  const int top = image.height - margin - height;
  if (top < margin || width + 2 * margin > image.width) return false;
  fill(image, margin, top, width, height, {32, 36, 41}, 0.85F);
  int y = top + 2 * gap;
  for (const LegendEntry& entry : legend) {
    fill(image, margin + gap, y, size, size, glm::vec3(entry.color), 1.0F);
    draw_text(image, atlas, static_cast<float>(margin + 2 * gap + size), static_cast<float>(y), entry.text,
              {224, 230, 235});
    y += line;
  }
  return true;
}

}  // namespace occlod::viewer
