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

// Returns the mean coverage of a part of the atlas, whose characters are several times as wide as they are drawn.
float coverage(const Atlas& atlas, float left, float right, int row) {
  const int begin = static_cast<int>(std::lround(left)),
            end = std::max(static_cast<int>(std::lround(right)), begin + 1);
  int sum = 0;
  for (int x = begin; x < end; ++x) sum += atlas.coverage[row * atlas.width + std::min(x, atlas.width - 1)];
  return static_cast<float>(sum) / static_cast<float>(255 * (end - begin));
}

void draw_text(Image& image, const Atlas& atlas, float left, float top, const std::string& ascii,
               const glm::vec3& color) {
  for (const char c : ascii) {
    const ImFontGlyph& glyph = *atlas.font->FindGlyph(static_cast<ImWchar>(c));
    const int x0 = static_cast<int>(std::lround(left + glyph.X0)), y0 = static_cast<int>(std::lround(top + glyph.Y0));
    const int width = static_cast<int>(std::ceil(glyph.X1 - glyph.X0)),
              height = static_cast<int>(std::lround(glyph.Y1 - glyph.Y0));
    const float u0 = glyph.U0 * static_cast<float>(atlas.width), u1 = glyph.U1 * static_cast<float>(atlas.width);
    const float step = (u1 - u0) / static_cast<float>(width);
    const int v0 = static_cast<int>(std::lround(glyph.V0 * static_cast<float>(atlas.height)));
    for (int y = 0; y < height && glyph.Visible; ++y)
      for (int x = 0; x < width; ++x) {
        const float u = u0 + static_cast<float>(x) * step;
        blend(image, x0 + x, y0 + y, color, coverage(atlas, u, u + step, v0 + y));
      }
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
