// Shading shows what the item buffer holds.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "picture/quads.h"
#include "scene/shading.h"

namespace occlod {
namespace {

using test::brightness;
using test::front_view;
using test::pixel;
using test::Quad;

Image shaded(std::span<const DrawObject> objects, const ShadeOptions& options = {}) {
  ItemBuffer items;
  draw_items(items, objects, front_view());
  return shade(items, objects, front_view(), options);
}

TEST(DrawItems, NumbersObjectByObject) {
  // At z = -4, a unit is 10 px: the left quad covers columns 10 to 39, the right one 60 to 89, both rows 20 to 59.
  // Moved down by a unit: 30 to 69.
  const Quad left(-4, -2, -1, 2, -4), right(1, -2, 4, 2, -4);
  DrawObject moved = right.object();
  moved.object_to_world[3] = glm::dvec4(0, -1, 0, 1);
  const std::array<DrawObject, 2> objects = {left.object(), moved};
  ItemBuffer items;
  draw_items(items, objects, front_view());
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 100; ++x) {
      const std::uint32_t item = items.items[static_cast<std::size_t>(100 * y + x)];
      const bool in_left = x >= 10 && x < 40 && y >= 20 && y < 60;
      const bool in_right = x >= 60 && x < 90 && y >= 30 && y < 70;
      // The first triangle of a quad is the one below its diagonal.
      ASSERT_EQ(item == 0 || item == 1, in_left) << x << "," << y;
      ASSERT_EQ(item == 2 || item == 3, in_right) << x << "," << y;
    }
  }
  EXPECT_EQ(items.items[100 * 58 + 38], 0U);
  EXPECT_EQ(items.items[100 * 21 + 11], 1U);
  EXPECT_EQ(items.items[100 * 68 + 88], 2U);
  EXPECT_EQ(items.items[100 * 31 + 61], 3U);
}

TEST(Shade, LeavesTheBackgroundAndFillsTheQuad) {
  const Quad quad(-4, -2, -1, 2, -4);
  const std::array<DrawObject, 1> objects = {quad.object()};
  const Image empty = shaded({});
  const Image image = shaded(objects, {.wire = false});
  ASSERT_EQ(image.width, 100);
  ASSERT_EQ(image.height, 80);
  ASSERT_EQ(image.pixels.size(), 8000U);
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 100; ++x)
      EXPECT_EQ(pixel(image, x, y) != pixel(empty, x, y), x >= 10 && x < 40 && y >= 20 && y < 60) << x << "," << y;
  for (int y = 0; y < 80; ++y) EXPECT_EQ(pixel(empty, 0, y), pixel(empty, 99, y));  // a vertical gradient
  EXPECT_NE(pixel(empty, 0, 0), pixel(empty, 0, 79));
}

TEST(Shade, OutlinesTheSilhouetteAndNothingElse) {
  const Quad quad(-4, -2, 4, 2, -4);  // columns 10 to 89
  const std::array<DrawObject, 1> objects = {quad.object()};
  const Image image = shaded(objects, {.wire = false});
  const int border = brightness(pixel(image, 10, 40));
  EXPECT_LT(border, brightness(pixel(image, 12, 40)));
  EXPECT_EQ(border, brightness(pixel(image, 89, 40)));
  // Flat and without lines: the two triangles differ at most by the direction to the eye from their centres.
  for (int x = 12; x < 88; ++x) EXPECT_NEAR(brightness(pixel(image, x, 40)), brightness(pixel(image, 12, 40)), 12);
}

TEST(Shade, ASlopeIsNoOutline) {
  // A floor seen at a flat angle falls away steeply but evenly.
  Quad floor(-50, -1, 50, -1, -1);
  floor.positions[2].z = floor.positions[3].z = -200;
  const std::array<DrawObject, 1> objects = {floor.object()};
  const Image image = shaded(objects, {.wire = false});
  // Rows 42 to 77 see it at depths 16 to 1.07, all in one plane under one light.
  for (int y = 42; y < 77; ++y) EXPECT_NEAR(brightness(pixel(image, 50, y)), brightness(pixel(image, 50, 60)), 12) << y;
}

TEST(Shade, IsTwoSided) {
  Quad quad(-4, -2, 4, 2, -4);
  const Image front = shaded(std::array{quad.object()});
  for (Triangle& triangle : quad.triangles) triangle = {triangle.x, triangle.z, triangle.y};
  EXPECT_EQ(shaded(std::array{quad.object()}).pixels, front.pixels);
}

TEST(Shade, WireDarkensTheDiagonalOnly) {
  const Quad quad(-4, -4, 4, 4, -4);  // columns 10 to 89, rows 0 to 79; the diagonal runs from (10, 80) to (90, 0)
  const Image plain = shaded(std::array{quad.object()}, {.wire = false});
  const Image wire = shaded(std::array{quad.object()}, {.wire = true});
  for (int y = 2; y < 78; ++y) {
    for (int x = 12; x < 88; ++x) {
      const double distance = std::abs((x + 0.5) + (y + 0.5) - 90.0) / std::sqrt(2.0);
      const int darker = brightness(pixel(plain, x, y)) - brightness(pixel(wire, x, y));
      EXPECT_TRUE(distance > 0.3 || darker > 30) << x << "," << y;
      EXPECT_TRUE(distance < 2.0 || darker == 0) << x << "," << y;
    }
  }
}

TEST(Shade, WireFadesOnTrianglesOfAPixel) {
  // A sheet of 200 x 160 cells over an image of 100 x 80: with lines drawn at full strength it would be dark
  // throughout.
  Quad sheet(0, 0, 0, 0, 0);
  sheet.positions.clear();
  sheet.triangles.clear();
  for (int j = 0; j <= 160; ++j)
    for (int i = 0; i <= 200; ++i) sheet.positions.emplace_back(-5.0 + 0.05 * i, -4.0 + 0.05 * j, -4.0);
  for (std::uint32_t j = 0; j < 160; ++j) {
    for (std::uint32_t i = 0; i < 200; ++i) {
      const std::uint32_t a = 201 * j + i;
      sheet.triangles.emplace_back(a, a + 1, a + 201);
      sheet.triangles.emplace_back(a + 1, a + 202, a + 201);
    }
  }
  EXPECT_EQ(shaded(std::array{sheet.object()}, {.wire = true}).pixels,
            shaded(std::array{sheet.object()}, {.wire = false}).pixels);
}

TEST(Shade, BlendsVertexColorsInPerspective) {
  // Red at the left corners, blue at the right ones, which are three times as far: half-way between them on the screen
  // the surface is a quarter of the way.
  Quad quad(-4, -4, 4, 4, -4);
  quad.positions[1] = {12, -12, -12};
  quad.positions[2] = {12, 12, -12};
  quad.colors = {{255, 0, 0, 255}, {0, 0, 255, 255}, {0, 0, 255, 255}, {255, 0, 0, 255}};
  const Image image = shaded(std::array{quad.object()}, {.wire = false});
  const glm::u8vec4 left = pixel(image, 13, 40), middle = pixel(image, 50, 40), right = pixel(image, 87, 40);
  EXPECT_GT(left.x, left.z);
  EXPECT_GT(right.z, right.x);
  EXPECT_GT(middle.x, middle.z + 30);  // 3 : 1 red; straight interpolation would make them even
  EXPECT_EQ(left.y, 0);
}

// All normals point at the viewer, whatever the triangles: the same colour everywhere but for the head light.
TEST(ShadeSmooth, TakesNormalsOfCornersAndDrawsNoOutlines) {
  const Quad quad(-4, -2, 4, 2, -4);  // columns 10 to 89
  DrawObject turned = quad.object();
  turned.object_to_world = glm::dmat4({1, 0, -0.2, 0}, {0, 1, 0, 0}, {0, 0, 1, 0},
                                      {0, 0, 0, 1});  // sheared: no longer parallel to the image
  const std::array<DrawObject, 1> objects = {quad.object()}, sheared = {turned};
  const auto smooth = [](std::span<const DrawObject> drawn, const glm::dvec3& normal) {
    ItemBuffer items;
    draw_items(items, drawn, front_view());
    return picture::shade_smooth(items, drawn, front_view(),
                                 [=](const DrawObject&, const glm::vec3&) { return normal; });
  };
  // The head light is 0.12 of all that comes straight back: from the middle to the border it falls by 0.12 (1 - cos 45
  // degrees), 0.035, where an outline takes 65 % away.
  const Image image = smooth(objects, {0, 0, 1});
  EXPECT_NEAR(brightness(pixel(image, 10, 40)), brightness(pixel(image, 12, 40)), 3);
  EXPECT_LT(brightness(pixel(shaded(objects, {.wire = false}), 10, 40)), brightness(pixel(image, 10, 40)) - 30);
  // The same normals in the world give the same light on another surface; without normals it gets its own.
  const Image same = smooth(sheared, glm::transpose(glm::dmat3(turned.object_to_world)) * glm::dvec3(0, 0, 1));
  EXPECT_NEAR(brightness(pixel(same, 50, 40)), brightness(pixel(image, 50, 40)), 3);
  const Image own = smooth(sheared, glm::dvec3(0.0));
  EXPECT_GT(std::abs(brightness(pixel(own, 50, 40)) - brightness(pixel(same, 50, 40))), 5);
}

}  // namespace
}  // namespace occlod
