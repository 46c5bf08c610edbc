// How far textures are from where they should be.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "occlod/compare.h"
#include "picture/quads.h"

namespace occlod {
namespace {

using test::front_view;
using test::parallel_view;
using test::Quad;

using Coordinates = std::array<glm::vec2, 4>;

constexpr Coordinates once = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

TexelBuffer texels(const Quad& quad, const ObjectTexture& texture, const View& view = front_view()) {
  const std::array objects = {quad.object()};
  ItemBuffer items;
  draw_items(items, objects, view);
  return find_texels(items, objects, view, {&texture, 1});
}

TexelBuffer texels(const Quad& quad, const Coordinates& coordinates, const View& view = front_view()) {
  return texels(quad, ObjectTexture{.coordinates = coordinates}, view);
}

Coordinates moved(Coordinates coordinates, const glm::vec2& by) {
  for (glm::vec2& at : coordinates) at += by;
  return coordinates;
}

const Quad wall(-3, -3, 3, 3, -4);  // 60 x 60 px from (20, 10) to (80, 70)

TEST(FindTexels, AreThoseOfPixelCentresInPerspective) {
  const TexelBuffer buffer = texels(wall, once);
  ASSERT_EQ(buffer.texels.size(), 100U * 80U);
  const Texel& texel = buffer.texels[15 * 100 + 30];  // 10.5 px from the left edge, 5.5 px below the upper one
  EXPECT_NEAR(texel.coordinate.x, 10.5 / 60, 1e-12);
  EXPECT_NEAR(texel.coordinate.y, 1.0 - 5.5 / 60, 1e-12);
  EXPECT_NEAR(texel.across.x, 1.0 / 60, 1e-12);
  EXPECT_NEAR(texel.across.y, 0.0, 1e-12);
  EXPECT_NEAR(texel.down.y, -1.0 / 60, 1e-12);
  EXPECT_EQ(buffer.texels[0].surface, 0U);
  // With right corners three times as far, half-way on the screen is a quarter of the way.
  Quad turned(-4, -4, 4, 4, -4);
  turned.positions[1] = {12, -12, -12};
  turned.positions[2] = {12, 12, -12};
  const TexelBuffer perspective = texels(turned, once);
  const double left = perspective.texels[40 * 100 + 49].coordinate.x;
  const double right = perspective.texels[40 * 100 + 50].coordinate.x;
  EXPECT_NEAR((left + right) / 2.0, 0.25, 1e-3);
}

TEST(FindTexels, TellObjectsAndMaterialsApart) {
  const std::array objects = {wall.object(), wall.object()};
  const std::array<MaterialId, 4> ids = {7, 7, 7, 7};
  const std::array<ObjectTexture, 2> textures = {{{.coordinates = once}, {.coordinates = once}}};
  const std::array<ObjectTexture, 2> of_material = {{{.coordinates = once, .vertex_materials = ids}, {}}};
  ItemBuffer items;
  draw_items(items, objects, front_view());
  ItemBuffer second = items;
  for (std::uint32_t& item : second.items)
    if (item != no_item) item += 2;
  const std::size_t middle = 40 * 100 + 50;
  const auto surface = [&](const ItemBuffer& drawn, const auto& laid) {
    return find_texels(drawn, objects, front_view(), laid).texels[middle].surface;
  };
  EXPECT_NE(surface(items, textures), surface(second, textures));
  EXPECT_NE(surface(items, textures), surface(items, of_material));
  EXPECT_EQ(surface(second, of_material), 0U);  // no coordinates
}

TEST(TextureSlip, IsNothingForTheSamePicture) {
  EXPECT_EQ(texture_slip_px(texels(wall, once), texels(wall, once)), 0.0);
}

// A pixel is 1/60 of the texture. What comes from beyond the wall's edge is nowhere in the full picture, and counts 10.
TEST(TextureSlip, IsTheLengthOfAShift) {
  const TexelBuffer full = texels(wall, once);
  for (const glm::dvec2 shift : {glm::dvec2(0.3, 0.0), glm::dvec2(0.0, -2.0), glm::dvec2(3.0, 4.0)}) {
    TexelBuffer shown = texels(wall, moved(once, glm::vec2(shift / 60.0)));
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 100; ++x)
        if (x < 27 || x > 72 || y < 17 || y > 62) shown.texels[static_cast<std::size_t>(y * 100 + x)] = {};
    const std::optional<double> slip = texture_slip_px(shown, full);
    ASSERT_TRUE(slip);
    EXPECT_NEAR(*slip, glm::length(shift), 1e-4);
  }
}

TEST(TextureSlip, IsTheSameWithParallelRays) {
  const TexelBuffer full = texels(wall, once, parallel_view());
  TexelBuffer shown = texels(wall, moved(once, {2.5F / 60, 0}), parallel_view());
  for (std::size_t i = 0; i < shown.texels.size(); ++i)
    if (i % 100 < 25 || i % 100 > 74) shown.texels[i] = {};
  EXPECT_NEAR(texture_slip_px(shown, full).value(), 2.5, 1e-4);
}

TEST(TextureSlip, CountsNoMoreThanItsLimit) {
  EXPECT_EQ(texture_slip_px(texels(wall, moved(once, {0.9F, 0.9F})), texels(wall, once)), largest_slip_px);
  const std::array<MaterialId, 4> ids = {1, 1, 1, 1};
  const ObjectTexture other{.coordinates = once, .vertex_materials = ids};
  EXPECT_EQ(texture_slip_px(texels(wall, other), texels(wall, once)), largest_slip_px);
}

// Two charts that meet in a seam. Where it has moved by 4 px, four of 60 columns show what the full picture has
// nowhere.
TEST(TextureSlip, CountsTheLimitBeyondSeams) {
  const auto halves = [](float seam) {
    Quad quad(-3, -3, seam, 3, -4);
    const Quad right(seam, -3, 3, 3, -4);
    quad.positions.insert(quad.positions.end(), right.positions.begin(), right.positions.end());
    quad.triangles.insert(quad.triangles.end(), {{4, 5, 6}, {4, 6, 7}});
    return quad;
  };
  const auto coordinates = [](float seam) {  // a sixtieth is a pixel on both sides
    const float at = (seam + 3) / 6;
    return std::vector<glm::vec2>{{5, 0}, {5 + at, 0}, {5 + at, 1}, {5, 1}, {at, 0}, {1, 0}, {1, 1}, {at, 1}};
  };
  const std::vector<glm::vec2> before = coordinates(0.0F), after = coordinates(0.4F);
  const TexelBuffer full = texels(halves(0.0F), ObjectTexture{.coordinates = before});
  const TexelBuffer shown = texels(halves(0.4F), ObjectTexture{.coordinates = after});
  EXPECT_NEAR(texture_slip_px(shown, full).value(), largest_slip_px * std::sqrt(4.0 / 60.0), 1e-3);
}

TEST(TextureSlip, IsNoneWithoutTexels) {
  EXPECT_FALSE(texture_slip_px(texels(wall, ObjectTexture()), texels(wall, once)));
  EXPECT_FALSE(texture_slip_px(texels(wall, once), texels(wall, ObjectTexture())));
  // All corners at one place of the texture: it could slip anywhere without being seen.
  EXPECT_FALSE(texture_slip_px(texels(wall, once), texels(wall, Coordinates())));
  // A line of the texture, but for rounding.
  const Coordinates line = {{{0, 0}, {0, 1e-6F}, {1, 1}, {1, 1}}};
  EXPECT_FALSE(texture_slip_px(texels(wall, once), texels(wall, line)));
}

}  // namespace
}  // namespace occlod
