// Every instruction set draws the same bits, and those of the rasteriser that draws items row by row without vectors.
#include <gtest/gtest.h>

#include <bit>
#include <numeric>
#include <random>
#include <vector>

#include "occlod/item_buffer.h"
#include "raster/depth_image.h"
#include "raster/every_target.h"
#include "raster/pixel_space.h"

namespace occlod {
namespace {

using test::for_every_target;
using test::pixel_to_clip;

struct Drawing {
  int width, height;
  glm::mat4 to_clip;
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;
};

std::vector<float> drawn_as_items(const Drawing& drawing) {
  ItemBuffer buffer;
  buffer.reset(drawing.width, drawing.height);
  draw_items(buffer, drawing.positions, drawing.triangles, drawing.to_clip, 0);
  return buffer.depth.nearness;
}

void expect_same_bits_everywhere(const Drawing& drawing) {
  const std::vector<float> expected = drawn_as_items(drawing);
  for_every_target([&](const char* target) {
    DepthBuffer depth;
    depth.reset(drawing.width, drawing.height);
    draw_depth(depth, drawing.positions, drawing.triangles, drawing.to_clip);
    for (std::size_t i = 0; i < expected.size(); ++i)
      ASSERT_EQ(std::bit_cast<std::uint32_t>(depth.nearness[i]), std::bit_cast<std::uint32_t>(expected[i]))
          << target << ", " << drawing.width << "x" << drawing.height << ", pixel " << i;
  });
}

// w = 2 + z, so that depth varies along and across; pixels as in pixel_to_clip at z = -1.
glm::mat4 sloped(int width, int height) {
  glm::mat4 m = pixel_to_clip(width, height);
  m[2][3] = 1.0F;
  m[3][3] = 2.0F;
  return m;
}

// Triangles of about `size` pixels, some of them slivers, across all borders of the image.
Drawing random_drawing(std::mt19937& random, int width, int height, float size) {
  Drawing drawing{width, height, sloped(width, height), {}, {}};
  std::uniform_real_distribution<float> x(-size, static_cast<float>(2 * width) + size),
      y(-size, static_cast<float>(2 * height) + size), z(-1.8F, 1.0F), offset(-size, size), sliver(0.0F, 1.0F);
  for (std::uint32_t i = 0; i < 200; ++i) {
    const glm::vec3 center(x(random), y(random), z(random));
    const float thin = sliver(random) < 0.2F ? 0.02F : 1.0F;
    for (int k = 0; k < 3; ++k)
      drawing.positions.push_back(center + glm::vec3(offset(random), thin * offset(random), 0.1F * z(random)));
    drawing.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  return drawing;
}

TEST(Targets, DrawTheSameBits) {
  std::mt19937 random(9);
  // Narrower than a block of any width, just as wide, and with borders inside of blocks.
  for (const auto& [width, height] : {std::pair{3, 40}, {7, 5}, {15, 33}, {16, 16}, {17, 9}, {100, 75}, {257, 130}})
    for (const float size : {1.0F, 4.0F, 12.0F, 40.0F, 90.0F, 400.0F})
      expect_same_bits_everywhere(random_drawing(random, width, height, size));
}

// The same picture, and as many fragments as the triangles cover pixels one by one. The last block of a row is moved
// back into the image, where it must not count what the block before it has counted.
TEST(Targets, CountTheSameFragments) {
  std::mt19937 random(12);
  for (const auto& [columns, rows] : {std::pair{3, 40}, {7, 5}, {16, 16}, {17, 9}, {41, 30}, {100, 75}})
    for (const float size : {1.0F, 12.0F, 40.0F, 200.0F}) {
      const Drawing drawing = random_drawing(random, columns, rows, size);
      const int width = drawing.width, height = drawing.height;
      const std::vector<int> coverage =
          test::count_coverage(drawing.positions, drawing.triangles, drawing.to_clip, width, height);
      const auto expected = static_cast<std::uint64_t>(std::accumulate(coverage.begin(), coverage.end(), 0));
      ItemBuffer items;
      items.reset(width, height);
      EXPECT_EQ(draw_items_counted(items, drawing.positions, drawing.triangles, drawing.to_clip, 0).fragments,
                expected);
      for_every_target([&](const char* target) {
        DepthBuffer depth;
        depth.reset(width, height);
        const DrawnPixels drawn = draw_depth_counted({depth.nearness.data(), width, height, width}, drawing.positions,
                                                     drawing.triangles, drawing.to_clip);
        EXPECT_EQ(drawn.fragments, expected) << target << ", " << width << "x" << height << ", size " << size;
        EXPECT_EQ(depth.nearness, items.depth.nearness) << target;
      });
    }
}

// At the limit between triangles drawn by edge functions and by rows, and where edge functions are largest: corners as
// far apart as 64 pixels, beginning before the image and ending beyond it.
TEST(Targets, AgreeAtTheLimitOfSmallTriangles) {
  std::mt19937 random(10);
  std::uniform_int_distribution<int> corner(-64 * 256, 90 * 256), choice(0, 2);
  for (int n = 0; n < 300; ++n) {
    const int extent = 64 * 256 + choice(random) - 1;
    const int x = corner(random), y = corner(random);
    Drawing drawing{90, 70, pixel_to_clip(90, 70), {}, {{0, 1, 2}, {3, 4, 5}}};
    for (const auto& [dx, dy] :
         {std::pair{0, 0}, {extent, extent}, {0, extent}, {extent, 0}, {extent / 2, extent}, {0, 1}})
      drawing.positions.emplace_back(static_cast<float>(x + dx) / 256.0F, static_cast<float>(y + dy) / 256.0F, 0.0F);
    expect_same_bits_everywhere(drawing);
  }
}

// A stride that is wider than the image: the rows are the same, and nothing is written beside them.
TEST(Targets, KeepToTheImage) {
  std::mt19937 random(11);
  const Drawing drawing = random_drawing(random, 37, 29, 30.0F);
  const std::vector<float> expected = drawn_as_items(drawing);
  for_every_target([&](const char* target) {
    constexpr std::ptrdiff_t stride = 64;
    std::vector<float> memory(stride * 29, 0.0F);
    for (std::ptrdiff_t y = 0; y < 29; ++y) std::fill_n(memory.begin() + y * stride + 37, stride - 37, -1.0F);
    draw_depth(DepthImage{memory.data(), 37, 29, stride}, drawing.positions, drawing.triangles, drawing.to_clip);
    for (std::size_t y = 0; y < 29; ++y)
      for (std::size_t x = 0; x < stride; ++x)
        ASSERT_EQ(memory[y * stride + x], x < 37 ? expected[y * 37 + x] : -1.0F) << target << " " << x << "," << y;
  });
}

}  // namespace
}  // namespace occlod
