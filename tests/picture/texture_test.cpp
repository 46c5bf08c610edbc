// Images laid over surfaces.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "occlod/picture.h"
#include "picture/quads.h"

namespace occlod {
namespace {

using test::brightness;
using test::front_view;
using test::pixel;
using test::Quad;

constexpr glm::u8vec4 red{255, 0, 0, 255}, blue{0, 0, 255, 255}, white{255, 255, 255, 255}, black{0, 0, 0, 255};

// color_of(column, row), rows from the top.
template <typename ColorOf>
Image image(int width, int height, const ColorOf& color_of) {
  Image result{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) result.pixels.push_back(color_of(x, y));
  return result;
}

Image shaded(const Quad& quad, const ObjectTexture& texture) {
  const std::array objects = {quad.object()};
  ItemBuffer items;
  draw_items(items, objects, front_view());
  return shade(items, objects, front_view(), {.wire = false, .textures = {&texture, 1}});
}

// The image once over a quad, (0, 0) at its first corner.
constexpr std::array<glm::vec2, 4> once = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

TEST(TextureImage, OriginsPutTheFirstRowOnTopOrBelow) {
  const Image red_over_blue = image(8, 8, [](int, int y) { return y < 4 ? red : blue; });
  const Quad quad(-4, -4, 4, 4, -4);  // its first corner is at the bottom left
  for (const bool on_top : {true, false}) {
    const TextureImage texture(red_over_blue,
                               {.origin = on_top ? TextureOrigin::bottom_left : TextureOrigin::top_left});
    const std::array<DrawMaterial, 1> materials = {{{glm::vec3(1.0F), &texture}}};
    const Image picture = shaded(quad, {.coordinates = once, .materials = materials});
    const glm::u8vec4 top = pixel(picture, 50, 10), bottom = pixel(picture, 50, 70);
    EXPECT_EQ(top.x > 100 && top.z == 0, on_top);
    EXPECT_EQ(bottom.z > 100 && bottom.x == 0, on_top);
  }
}

// The right corners are three times as far: half-way on the screen the surface is a quarter of the way, where the image
// turns from red to blue.
TEST(TextureImage, IsLaidInPerspective) {
  const TextureImage texture(image(256, 4, [](int x, int) { return x < 64 ? red : blue; }));
  const std::array<DrawMaterial, 1> materials = {{{glm::vec3(1.0F), &texture}}};
  Quad quad(-4, -4, 4, 4, -4);
  quad.positions[1] = {12, -12, -12};
  quad.positions[2] = {12, 12, -12};
  const Image picture = shaded(quad, {.coordinates = once, .materials = materials});
  // The left edge is at 10 px, the right one at 90; two pixels' width of blending is left out.
  for (const int y : {30, 50}) {
    for (int x = 12; x < 48; ++x) EXPECT_TRUE(pixel(picture, x, y).x > 60 && pixel(picture, x, y).z == 0) << x;
    for (int x = 53; x < 88; ++x) EXPECT_TRUE(pixel(picture, x, y).z > 60 && pixel(picture, x, y).x == 0) << x;
  }
}

// Beyond [0, 1], along each coordinate by itself. Four columns 0, 51, 102, 153 and rows likewise in green.
TEST(TextureImage, Wraps) {
  const Image steps = image(4, 4, [](int x, int y) {
    return glm::u8vec4(51 * x, 51 * (3 - y), 0, 255);  // the bottom row is 0
  });
  const auto column = [&](TextureWrap wrap, double s) {
    const TextureImage texture(steps, {.wrap_s = wrap});
    const float linear = texture.sample({s, 0.125}, {0, 0}, {0, 0}).x;
    const double srgb = linear <= 0.0031308F ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
    return std::lround(5.0 * srgb);
  };
  const auto columns = [&](TextureWrap wrap) {
    std::vector<long> found;
    for (int i = -4; i < 8; ++i) found.push_back(column(wrap, (i + 0.5) / 4.0));  // the middles of pixels
    return found;
  };
  EXPECT_EQ(columns(TextureWrap::repeat), (std::vector<long>{0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3}));
  EXPECT_EQ(columns(TextureWrap::clamp), (std::vector<long>{0, 0, 0, 0, 0, 1, 2, 3, 3, 3, 3, 3}));
  EXPECT_EQ(columns(TextureWrap::mirror), (std::vector<long>{3, 2, 1, 0, 0, 1, 2, 3, 3, 2, 1, 0}));
  const TextureImage texture(steps, {.wrap_t = TextureWrap::clamp});
  EXPECT_EQ(texture.sample({0.125, 7.0}, {0, 0}, {0, 0}), texture.sample({0.125, 0.875}, {0, 0}, {0, 0}));
  EXPECT_NE(texture.sample({0.125, 7.0}, {0, 0}, {0, 0}), texture.sample({0.125, 0.125}, {0, 0}, {0, 0}));
}

// Black and white pixels in turns, seen so small that each pixel of the picture covers many: half the light.
TEST(TextureImage, AveragesLightWhereItIsSmall) {
  const TextureImage texture(image(256, 256, [](int x, int y) { return (x + y) % 2 == 0 ? white : black; }));
  for (const double step : {2.0 / 256, 0.1, 1.0, 50.0}) {
    const glm::vec3 light = texture.sample({0.3, 0.6}, {step, 0}, {0, step});
    EXPECT_NEAR(light.x, 0.5F, 0.01F) << step;
  }
}

// Columns four pixels wide, seen at a flat angle along them: 16 pixels from row to row, one from column to column. Only
// along the columns is there something to average.
TEST(TextureImage, StaysSharpAcrossAFlatAngle) {
  const TextureImage texture(image(256, 256, [](int x, int) { return x / 4 % 2 == 0 ? white : black; }));
  const auto light = [&](double x) { return texture.sample({x / 256, 0.5}, {1.0 / 256, 0}, {0, 16.0 / 256}).x; };
  EXPECT_GT(light(10.0), 0.9F);
  EXPECT_LT(light(14.0), 0.1F);
}

TEST(TextureImage, IsWhiteWhereCoordinatesAreNoNumbers) {
  const TextureImage texture(image(2, 2, [](int, int) { return black; }));
  EXPECT_EQ(texture.sample({std::nan(""), 0}, {0, 0}, {0, 0}), glm::vec3(1.0F));
  EXPECT_EQ(texture.sample({0, 0}, {INFINITY, 0}, {0, 0}), glm::vec3(1.0F));
}

// Squares of 8 pixels: equal within, light beside dark.
TEST(CheckerImage, HasSquaresInTurns) {
  const Image checker = checker_image(4, 8);
  ASSERT_EQ(checker.width, 32);
  ASSERT_EQ(checker.pixels.size(), 1024U);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      EXPECT_EQ(pixel(checker, x, y), pixel(checker, x / 8 * 8, y / 8 * 8));
      const bool is_light = (x / 8 + y / 8) % 2 == 0;
      EXPECT_EQ(brightness(pixel(checker, x, y)) > 380, is_light) << x << "," << y;
    }
  }
}

// Triangle 0 has corners 0, 1, 2 and triangle 1 has 2, 3, 0 of a second set: the first corner says the material.
TEST(Materials, BelongToTheFirstCorner) {
  Quad quad(-4, -4, 4, 4, -4);
  quad.positions.insert(quad.positions.end(), {quad.positions[0], quad.positions[2], quad.positions[3]});
  quad.triangles = {{0, 1, 2}, {4, 5, 6}};
  quad.triangles[1] = {4, 5, 6};  // corners 0, 2, 3 again
  const std::vector<MaterialId> ids = {0, 0, 0, 0, 1, 1, 1};
  const std::array<DrawMaterial, 2> materials = {{{{1, 0, 0}, nullptr}, {{0, 0, 1}, nullptr}}};
  const Image picture = shaded(quad, {.vertex_materials = ids, .materials = materials});
  const glm::u8vec4 below = pixel(picture, 80, 60), above = pixel(picture, 20, 20);
  EXPECT_TRUE(below.x > 60 && below.z == 0);
  EXPECT_TRUE(above.z > 60 && above.x == 0);
}

// They multiply vertex colours, and replace the colour of objects without.
TEST(Materials, MultiplyVertexColors) {
  Quad quad(-4, -4, 4, 4, -4);
  const std::array<DrawMaterial, 1> half = {{{glm::vec3(0.0F, 1.0F, 0.0F), nullptr}}};
  const glm::u8vec4 plain = pixel(shaded(quad, {.materials = half}), 30, 60);
  EXPECT_TRUE(plain.x == 0 && plain.y > 60 && plain.z == 0);
  quad.colors.assign(4, {255, 128, 255, 255});
  const glm::u8vec4 colored = pixel(shaded(quad, {.materials = half}), 30, 60);
  EXPECT_TRUE(colored.x == 0 && colored.y > 20 && colored.y < plain.y && colored.z == 0);
}

TEST(Materials, NoneLeaveThePictureAsItIs) {
  const Quad quad(-4, -4, 4, 4, -4);
  const std::array objects = {quad.object()};
  ItemBuffer items;
  draw_items(items, objects, front_view());
  EXPECT_EQ(shaded(quad, {.coordinates = once}).pixels, shade(items, objects, front_view(), {.wire = false}).pixels);
}

}  // namespace
}  // namespace occlod
