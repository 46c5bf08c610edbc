// Which pixels a triangle covers: exactly those whose centre it holds, by the top-left rule.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "raster/pixel_space.h"

namespace occlod {
namespace {

using test::coordinate;
using test::count_coverage;
using test::pixel_to_clip;

constexpr int width = 64;
constexpr int height = 48;

struct Point {
  std::int64_t x, y;  // 1/256 pixels, y down
};

// The textbook test, in exact integers: inside of or on an edge that is a top or a left edge.
bool owns(std::array<Point, 3> p, Point q) {
  const auto cross = [](Point a, Point b, Point c) { return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y); };
  const std::int64_t area = cross(p[0], p[1], p[2]);
  if (area == 0) return false;
  if (area < 0) std::swap(p[1], p[2]);  // now clockwise on the screen: the inside is where all three are positive
  for (std::size_t i = 0; i < 3; ++i) {
    const Point a = p[i], b = p[(i + 1) % 3];
    const std::int64_t e = cross(a, b, q);
    const bool top = a.y == b.y && b.x > a.x;
    const bool left = b.y < a.y;
    if (e < 0 || (e == 0 && !top && !left)) return false;
  }
  return true;
}

Point snapped(const glm::vec3& v) { return {std::llround(v.x * 256.0F), std::llround(v.y * 256.0F)}; }

TEST(Coverage, EqualsTheExactPointInTriangleTest) {
  std::mt19937 random(1);
  const glm::mat4 to_clip = pixel_to_clip(width, height);
  std::size_t covered = 0;
  for (int n = 0; n < 6000; ++n) {
    // Halves and quarters of a pixel put many edges and corners exactly on pixel centres; a range around the image
    // crosses its borders.
    const int fraction = std::array{1, 2, 4, 256}[static_cast<std::size_t>(n % 4)];
    const int range = n % 3 == 0 ? 8 : 0;
    std::array<glm::vec3, 3> corners;
    for (glm::vec3& c : corners) {
      c = range > 0 ? glm::vec3(coordinate(random, 20, 20 + range, fraction),
                                coordinate(random, 20, 20 + range, fraction), 0.0F)
                    : glm::vec3(coordinate(random, -30, width + 30, fraction),
                                coordinate(random, -30, height + 30, fraction), 0.0F);
    }
    const Triangle triangle(0, 1, 2);
    DepthBuffer depth;
    depth.reset(width, height);
    draw_depth(depth, corners, {&triangle, 1}, to_clip);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const bool expected =
            owns({snapped(corners[0]), snapped(corners[1]), snapped(corners[2])}, {256 * x + 128, 256 * y + 128});
        const bool drawn = depth.nearness[static_cast<std::size_t>(y * width + x)] > 0.0F;
        ASSERT_EQ(drawn, expected) << "triangle " << n << " pixel " << x << "," << y;
        covered += drawn ? 1 : 0;
      }
    }
  }
  EXPECT_GT(covered, 500'000U);  // the test has seen something
}

// Corners as far out as they are drawn without clipping: products of differences come near 2^48 there.
TEST(Coverage, IsExactForTrianglesAsLargeAsTheGuardBand) {
  std::mt19937 random(2);
  const glm::mat4 to_clip = pixel_to_clip(width, height);
  for (int n = 0; n < 300; ++n) {
    std::array<glm::vec3, 3> corners;
    for (glm::vec3& c : corners)
      c = {coordinate(random, -32000, 32000, 256), coordinate(random, -32000, 32000, 256), 0.0F};
    // Through the image: the third corner mirrors the first about its middle, almost.
    corners[2] = glm::vec3(width - corners[0].x, height - corners[0].y + 0.25F, 0.0F);
    const Triangle triangle(0, 1, 2);
    DepthBuffer depth;
    depth.reset(width, height);
    draw_depth(depth, corners, {&triangle, 1}, to_clip);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        ASSERT_EQ(depth.nearness[static_cast<std::size_t>(y * width + x)] > 0.0F,
                  owns({snapped(corners[0]), snapped(corners[1]), snapped(corners[2])}, {256 * x + 128, 256 * y + 128}))
            << "triangle " << n << " pixel " << x << "," << y;
  }
}

// A jittered grid that reaches beyond the image on all sides is a closed surface over it: one owner a pixel, however
// the triangles are turned.
TEST(Coverage, OfAClosedSurfaceIsOnceForEachPixel) {
  std::mt19937 random(3);
  for (const int fraction : {1, 2, 256}) {
    constexpr int cells = 9;
    std::vector<glm::vec3> positions;
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i)
        // Cells of 10 pixels and jitter of at most 2 cannot fold.
        positions.push_back(glm::vec3(10 * i - 10, 10 * j - 10, 0) +
                            glm::vec3(coordinate(random, -2, 2, fraction), coordinate(random, -2, 2, fraction), 0));
    std::vector<Triangle> triangles;
    for (std::uint32_t j = 0; j < cells; ++j) {
      for (std::uint32_t i = 0; i < cells; ++i) {
        const std::uint32_t a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
        const bool turned = std::uniform_int_distribution<int>(0, 1)(random) == 1;
        triangles.push_back(turned ? Triangle(b, a, c) : Triangle(a, b, c));
        triangles.push_back(turned ? Triangle(d, c, b) : Triangle(b, c, d));
      }
    }
    for (const int count : count_coverage(positions, triangles, pixel_to_clip(width, height), width, height))
      ASSERT_EQ(count, 1);
  }
}

TEST(Coverage, OfAFanAroundAPixelCentreIsOnce) {
  // The centre of pixel (20, 20) is a corner of every triangle of the fan: one of them owns it.
  std::vector<glm::vec3> positions = {{20.5F, 20.5F, 0.0F}};
  constexpr std::uint32_t spokes = 12;
  for (std::uint32_t i = 0; i < spokes; ++i) {
    const double angle = 2.0 * M_PI * i / spokes;
    positions.emplace_back(20.5 + 8.0 * std::cos(angle), 20.5 + 8.0 * std::sin(angle), 0.0);
  }
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < spokes; ++i) triangles.emplace_back(0, 1 + i, 1 + (i + 1) % spokes);
  const std::vector<int> count = count_coverage(positions, triangles, pixel_to_clip(width, height), width, height);
  // The fan holds a circle of radius 8 cos(15 deg) = 7.7; these centres are at most 7.1 away.
  for (int y = 15; y <= 25; ++y)
    for (int x = 15; x <= 25; ++x) EXPECT_EQ(count[static_cast<std::size_t>(y * width + x)], 1) << x << "," << y;
}

TEST(Coverage, OfTrianglesWithoutAreaIsNothing) {
  const std::vector<glm::vec3> positions = {{1, 1, 0}, {30, 30, 0}, {11, 11, 0}, {5.5F, 5.5F, 0}, {5.5F, 40.5F, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 0, 1}, {3, 3, 3}, {3, 4, 4}};
  for (const int count : count_coverage(positions, triangles, pixel_to_clip(width, height), width, height))
    EXPECT_EQ(count, 0);
}

TEST(Coverage, OfTrianglesBetweenPixelCentresIsNothing) {
  // Inside one pixel but beside its centre (10.5, 10.5), and a sliver between two columns of centres.
  const std::vector<glm::vec3> positions = {{10.6F, 10.1F, 0}, {10.9F, 10.1F, 0}, {10.9F, 10.9F, 0},
                                            {10.6F, 2, 0},     {11.4F, 2, 0},     {11, 44, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 4, 5}};
  for (const int count : count_coverage(positions, triangles, pixel_to_clip(width, height), width, height))
    EXPECT_EQ(count, 0);
}

TEST(Coverage, SkipsCornersThatAreNotFiniteAndNothingElse) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<glm::vec3> positions = {{-10, -10, 0},    {200, -10, 0},     {-10, 200, 0}, {nan, 5, 0},
                                            {5, infinity, 0}, {5, -infinity, 0}, {5, 5, nan}};
  const glm::mat4 to_clip = pixel_to_clip(width, height);
  const std::vector<Triangle> bad = {{0, 1, 3}, {4, 1, 2}, {0, 5, 2}, {3, 4, 5}, {6, 1, 2}};
  for (const int count : count_coverage(positions, bad, to_clip, width, height)) EXPECT_EQ(count, 0);
  const std::vector<Triangle> mixed = {{0, 1, 3}, {0, 1, 2}, {6, 4, 2}};
  ItemBuffer buffer;
  buffer.reset(width, height);
  draw_items(buffer, positions, mixed, to_clip, 0);
  for (const std::uint32_t item : buffer.items) ASSERT_EQ(item, 1U);
}

TEST(Coverage, ReachesEveryBorderPixelOfAnySize) {
  for (const auto& [w, h] : {std::pair{1, 1}, {2, 1}, {3, 7}, {17, 5}}) {
    const std::vector<glm::vec3> positions = {{0, 0, 0}, {w, 0, 0}, {0, h, 0}, {w, h, 0}};
    const std::vector<Triangle> triangles = {{0, 1, 2}, {1, 3, 2}};
    for (const int count : count_coverage(positions, triangles, pixel_to_clip(w, h), w, h))
      EXPECT_EQ(count, 1) << w << "x" << h;
  }
}

}  // namespace
}  // namespace occlod
