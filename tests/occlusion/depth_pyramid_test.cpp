// The pyramid answers what a loop over the pixels answers.
#include "raster/depth_pyramid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <utility>

namespace occlod {
namespace {

// Blocks of few different depths, with single pixels of noise: many texels on the border between decided and undecided,
// and many ties.
DepthBuffer random_depth(std::mt19937& random, int width, int height) {
  std::uniform_int_distribution<int> level(0, 6), x(0, width), y(0, height), percent(0, 99);
  DepthBuffer depth;
  depth.reset(width, height);
  std::fill(depth.nearness.begin(), depth.nearness.end(), 0.5F);
  for (int block = 0; block < 6; ++block) {
    const auto [x0, x1] = std::minmax({x(random), x(random)});
    const auto [y0, y1] = std::minmax({y(random), y(random)});
    const float value = 0.125F * static_cast<float>(level(random));
    for (int j = y0; j < y1; ++j) std::fill_n(depth.nearness.begin() + j * width + x0, x1 - x0, value);
  }
  for (float& z : depth.nearness)
    if (percent(random) == 0) z = 0.125F * static_cast<float>(level(random));
  return depth;
}

std::uint32_t count_by_pixels(const DepthBuffer& depth, const PixelRect& rect, float nearest) {
  std::uint32_t count = 0;
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x)
      count += depth.nearness[static_cast<std::size_t>(y * depth.width + x)] <= nearest ? 1U : 0U;
  return count;
}

constexpr std::pair<int, int> sizes[] = {{1, 1}, {1, 9}, {7, 5}, {16, 16}, {33, 65}, {100, 75}, {129, 40}};

TEST(DepthPyramid, EachTexelIsTheFarthestOfItsPixels) {
  std::mt19937 random(1);
  for (const auto& [width, height] : sizes) {
    const DepthBuffer depth = random_depth(random, width, height);
    DepthPyramid pyramid;
    pyramid.build(depth);
    for (int level = 0; level < pyramid.level_count(); ++level) {
      const int side = 1 << level;
      for (int y = 0; y * side < height; ++y) {
        for (int x = 0; x * side < width; ++x) {
          float farthest = std::numeric_limits<float>::infinity();
          for (int j = y * side; j < std::min((y + 1) * side, height); ++j)
            for (int i = x * side; i < std::min((x + 1) * side, width); ++i)
              farthest = std::min(farthest, depth.nearness[static_cast<std::size_t>(j * width + i)]);
          ASSERT_EQ(pyramid.farthest(level, x, y), farthest)
              << width << "x" << height << " level " << level << ": " << x << "," << y;
        }
      }
    }
    // The last level is one texel: 2^(levels - 1) is the first power of two that is not smaller than the image.
    EXPECT_GE(1 << (pyramid.level_count() - 1), std::max(width, height));
    EXPECT_LT((1 << (pyramid.level_count() - 1)) / 2, std::max(width, height));
  }
}

TEST(DepthPyramid, AnswersAsALoopOverThePixels) {
  std::mt19937 random(2);
  std::uniform_int_distribution<int> level(-1, 7);
  DepthPyramid pyramid;  // reused: what an earlier, larger image left behind must not matter
  std::size_t visible = 0, hidden = 0;
  for (int round = 0; round < 20; ++round) {
    for (const auto& [width, height] : sizes) {
      const DepthBuffer depth = random_depth(random, width, height);
      pyramid.build(depth);
      for (int n = 0; n < 400; ++n) {
        std::uniform_int_distribution<int> x(0, width), y(0, height);
        const auto [x0, x1] = std::minmax({x(random), x(random)});
        const auto [y0, y1] = std::minmax({y(random), y(random)});
        const PixelRect rect{x0, y0, x1, y1};
        // The very values of the image, where < and <= differ.
        const float nearest = 0.125F * static_cast<float>(level(random));
        const std::uint32_t expected = count_by_pixels(depth, rect, nearest);
        ASSERT_EQ(pyramid.count_visible(rect, nearest), expected);
        ASSERT_EQ(pyramid.any_visible(rect, nearest), expected > 0)
            << width << "x" << height << ": " << x0 << "," << y0 << " " << x1 << "," << y1;
        (expected > 0 ? visible : hidden) += x0 < x1 && y0 < y1 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(visible, 5000U);
  EXPECT_GT(hidden, 5000U);
}

// With diagonals: a loop over the pixels that they meet.
TEST(DepthPyramid, AnswersAsALoopOverThePixelsOfAnOctagon) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> level(0, 6);
  std::size_t visible = 0, hidden = 0;
  for (int round = 0; round < 20; ++round) {
    for (const auto& [width, height] : sizes) {
      const DepthBuffer depth = random_depth(random, width, height);
      DepthPyramid pyramid;
      pyramid.build(depth);
      for (int n = 0; n < 200; ++n) {
        std::uniform_int_distribution<int> x(0, width), y(0, height);
        const auto [x0, x1] = std::minmax({x(random), x(random)});
        const auto [y0, y1] = std::minmax({y(random), y(random)});
        // Through the middle of the rectangle, half a band wide; on quarters, where pixels just meet or just do not.
        std::uniform_int_distribution<int> half_band(0, 4 * std::max({x1 - x0, y1 - y0, 1}));
        const double sum = 0.5 * (x0 + x1 + y0 + y1), difference = 0.5 * (x0 + x1 - y0 - y1);
        const Diagonals diagonals = {sum - 0.25 * half_band(random), sum + 0.25 * half_band(random),
                                     difference - 0.25 * half_band(random), difference + 0.25 * half_band(random)};
        const float nearest = 0.125F * static_cast<float>(level(random));
        std::uint32_t expected = 0;
        for (int j = y0; j < y1; ++j)
          for (int i = x0; i < x1; ++i) {
            const bool meets = i + j + 2 >= diagonals.sum_low && i + j <= diagonals.sum_high &&
                               i + 1 - j >= diagonals.difference_low && i - j - 1 <= diagonals.difference_high;
            expected += meets ? count_by_pixels(depth, {i, j, i + 1, j + 1}, nearest) : 0U;
          }
        ASSERT_EQ(pyramid.count_visible({x0, y0, x1, y1}, nearest, diagonals), expected);
        ASSERT_EQ(pyramid.any_visible({x0, y0, x1, y1}, nearest, diagonals), expected > 0);
        (expected > 0 ? visible : hidden) += x0 < x1 && y0 < y1 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(visible, 3000U);
  EXPECT_GT(hidden, 3000U);
}

// One visible pixel anywhere in a large hidden rectangle is found, one beside it is not.
TEST(DepthPyramid, FindsOnePixel) {
  DepthBuffer depth;
  depth.reset(67, 51);
  const PixelRect rect{5, 3, 62, 50};
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      std::fill(depth.nearness.begin(), depth.nearness.end(), 0.5F);
      depth.nearness[static_cast<std::size_t>(y * depth.width + x)] = 0.25F;
      DepthPyramid pyramid;
      pyramid.build(depth);
      const bool inside = x >= rect.x0 && x < rect.x1 && y >= rect.y0 && y < rect.y1;
      ASSERT_EQ(pyramid.any_visible(rect, 0.25F), inside) << x << "," << y;
    }
  }
}

}  // namespace
}  // namespace occlod
