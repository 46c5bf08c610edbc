// How deep, and whose: interpolation, the nearer one, ties, item numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "occlod/view.h"
#include "raster/pixel_space.h"
#include "support/cameras.h"

namespace occlod {
namespace {

using test::pixel_to_clip;

View test_view() { return View(test::origin_camera(80, 60)); }

// Looking along -z with f = 30 px: the ray through pixel (x, y) at depth 1 is ((x - 39.5) / 30, (29.5 - y) / 30, -1).
// It meets the plane n . p = d at depth d / (n . ray), so 1 / w = (n . ray) / d.
double inverse_depth_on_plane(const glm::dvec3& normal, double d, int x, int y) {
  return (normal.x * (x - 39.5) / 30.0 + normal.y * (29.5 - y) / 30.0 - normal.z) / d;
}

// Draws random triangles between two z: each pixel has exact_at(n, d, x, y) of its plane n . p = d.
template <typename Exact>
void expect_planes(const View& view, unsigned seed, float nearest_z, float farthest_z, const Exact& exact_at) {
  const ObjectView object(view, glm::dmat4(1.0));
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> across(-8.0F, 8.0F), along(farthest_z, nearest_z);
  std::size_t checked = 0;
  for (int n = 0; n < 400; ++n) {
    std::vector<glm::vec3> p;
    for (int i = 0; i < 3; ++i) p.emplace_back(across(random), across(random), along(random));
    const glm::dvec3 normal = glm::cross(glm::dvec3(p[1] - p[0]), glm::dvec3(p[2] - p[0]));
    const double d = glm::dot(normal, glm::dvec3(p[0]));
    const Triangle triangle(0, 1, 2);
    DepthBuffer depth;
    depth.reset(80, 60);
    draw_depth(depth, p, {&triangle, 1}, object.object_to_clip());
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 80; ++x) {
        const double drawn = depth.nearness[static_cast<std::size_t>(80 * y + x)];
        if (drawn == 0.0) continue;
        const double exact = exact_at(normal, d, x, y);
        // Snapping moves each corner by at most 1/512 px along both axes, and with it the plane by what it rises in
        // that distance; twice that is allowed because a sliver's slope is itself changed.
        const double slope =
            std::abs(exact_at(normal, d, x + 1, y) - exact) + std::abs(exact_at(normal, d, x, y + 1) - exact);
        if (slope > 0.02) continue;  // seen edge-on
        EXPECT_NEAR(drawn, exact, 1e-6 + slope / 256.0) << n << ": " << x << "," << y;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 10'000U);
}

// 6 units are 60 pixels high, nearness is 1 at distance 2 and 0 at 12.
View parallel_view() {
  Camera camera = test_view().camera();
  camera.orthographic_height = 6.0;
  camera.near = 2.0;
  camera.far = 12.0;
  return View(camera);
}

TEST(Depth, IsThatOfThePlaneAtThePixelCentre) { expect_planes(test_view(), 4, -2.0F, -20.0F, inverse_depth_on_plane); }

// The ray through pixel (x, y) is along -z through ((x - 39.5) / 10, (29.5 - y) / 10). It meets the plane n . p = d at
// distance t = (n_x X + n_y Y - d) / n_z; what is nearer than 2 or farther than 12 is cut off.
TEST(Depth, OfParallelRaysIsThatOfThePlaneAtThePixelCentre) {
  expect_planes(parallel_view(), 6, 2.0F, -16.0F, [](const glm::dvec3& normal, double d, int x, int y) {
    const double distance = (normal.x * (x - 39.5) / 10.0 + normal.y * (29.5 - y) / 10.0 - d) / normal.z;
    return (12.0 - distance) / 10.0;
  });
}

// A square over the whole picture is there between the planes, and nowhere else.
TEST(Depth, OfParallelRaysEndsAtBothPlanes) {
  const glm::mat4 to_clip = ObjectView(parallel_view(), glm::dmat4(1.0)).object_to_clip();
  const Triangle triangles[] = {{0, 1, 2}, {0, 2, 3}};
  for (const float z : {-1.99F, -2.01F, -11.99F, -12.01F, -1e6F}) {
    const std::vector<glm::vec3> p = {{-9, -9, z}, {9, -9, z}, {9, 9, z}, {-9, 9, z}};
    DepthBuffer depth;
    depth.reset(80, 60);
    draw_depth(depth, p, triangles, to_clip);
    for (const float drawn : depth.nearness)
      ASSERT_NEAR(drawn, z < -2.0F && z > -12.0F ? (12.0F + z) / 10.0F : 0.0F, 1e-6F) << z;
  }
}

TEST(Depth, NeverLeavesTheRangeOfTheCorners) {
  // Slivers whose depth gradient is enormous: a sample cannot be nearer than the nearest corner.
  const View view = test_view();
  const glm::mat4 to_clip = ObjectView(view, glm::dmat4(1.0)).object_to_clip();
  std::mt19937 random(5);
  std::uniform_real_distribution<float> jitter(-0.01F, 0.01F), along(-90.0F, -0.1F);
  for (int n = 0; n < 2000; ++n) {
    const float nearest = along(random), farthest = along(random);
    const std::vector<glm::vec3> p = {{-0.5F * nearest + jitter(random), 0.3F * nearest, nearest},
                                      {0.5F * farthest, -0.3F * farthest + jitter(random), farthest},
                                      {0.49F * farthest, -0.3F * farthest, farthest}};
    const Triangle triangle(0, 1, 2);
    DepthBuffer depth;
    depth.reset(80, 60);
    draw_depth(depth, p, {&triangle, 1}, to_clip);
    const auto largest = static_cast<float>(1.0 / std::min(-double{nearest}, -double{farthest}));
    const auto smallest = static_cast<float>(1.0 / std::max(-double{nearest}, -double{farthest}));
    for (const float z : depth.nearness)
      EXPECT_TRUE(z == 0.0F || (z >= smallest * 0.999999F && z <= largest * 1.000001F)) << n;
  }
}

// Two full-screen triangles at w = 5 and w = 4, in either order.
TEST(Depth, NearerWinsWhateverIsDrawnFirst) {
  const glm::mat4 to_clip = ObjectView(test_view(), glm::dmat4(1.0)).object_to_clip();
  const std::vector<glm::vec3> p = {{-50, -50, -5}, {50, -50, -5}, {0, 90, -5},
                                    {-50, -50, -4}, {50, -50, -4}, {0, 90, -4}};
  for (const std::vector<Triangle>& triangles :
       {std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}}, std::vector<Triangle>{{3, 4, 5}, {0, 1, 2}}}) {
    ItemBuffer buffer;
    buffer.reset(80, 60);
    draw_items(buffer, p, triangles, to_clip, 0);
    for (const std::uint32_t item : buffer.items) ASSERT_EQ(item, triangles[0] == Triangle(3, 4, 5) ? 0U : 1U);
    for (const float z : buffer.depth.nearness) ASSERT_FLOAT_EQ(z, 0.25F);
  }
}

TEST(Depth, FirstWinsAtEqualDepth) {
  const std::vector<glm::vec3> p = {{-10, -10, 0}, {200, -10, 0}, {-10, 200, 0}};
  ItemBuffer buffer;
  buffer.reset(32, 32);
  draw_items(buffer, p, std::vector<Triangle>{{0, 1, 2}, {2, 1, 0}}, pixel_to_clip(32, 32), 7);
  draw_items(buffer, p, std::vector<Triangle>{{1, 2, 0}}, pixel_to_clip(32, 32), 100);
  for (const std::uint32_t item : buffer.items) ASSERT_EQ(item, 7U);
}

TEST(Items, AreNumberedThroughAllBatches) {
  // Triangle i covers the centre of pixel i and no other.
  constexpr int width = 20, height = 10;
  std::vector<glm::vec3> p;
  std::vector<Triangle> triangles;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto first = static_cast<std::uint32_t>(p.size());
      p.emplace_back(x + 0.25, y + 0.25, 0);
      p.emplace_back(x + 0.9, y + 0.25, 0);
      p.emplace_back(x + 0.25, y + 0.9, 0);
      triangles.emplace_back(first, first + 1, first + 2);
    }
  }
  ItemBuffer buffer;
  buffer.reset(width, height);
  draw_items(buffer, p, triangles, pixel_to_clip(width, height), 1000);
  for (std::uint32_t i = 0; i < width * height; ++i) ASSERT_EQ(buffer.items[i], 1000 + i);
  EXPECT_EQ(count_visible_items(buffer, 1200), 200U);
}

TEST(Items, CountsEachVisibleItemOnce) {
  ItemBuffer buffer;
  buffer.reset(3, 2);
  EXPECT_EQ(count_visible_items(buffer, 5), 0U);
  buffer.items = {4, 4, no_item, 0, 4, no_item};
  EXPECT_EQ(count_visible_items(buffer, 5), 2U);
}

TEST(Items, AndDepthAloneAgree) {
  const View view = test_view();
  const glm::mat4 to_clip = ObjectView(view, glm::dmat4(1.0)).object_to_clip();
  std::mt19937 random(6);
  std::uniform_real_distribution<float> any(-10.0F, 10.0F);
  std::vector<glm::vec3> p;
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < 300; ++i) {
    for (int k = 0; k < 3; ++k) p.emplace_back(any(random), any(random), any(random));
    triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  DepthBuffer depth;
  depth.reset(80, 60);
  draw_depth(depth, p, triangles, to_clip);
  ItemBuffer buffer;
  buffer.reset(80, 60);
  draw_items(buffer, p, triangles, to_clip, 0);
  EXPECT_EQ(depth.nearness, buffer.depth.nearness);
}

TEST(DepthBuffer, ResetEmptiesAndResizes) {
  ItemBuffer buffer;
  buffer.reset(4, 3);
  buffer.items[5] = 1;
  buffer.depth.nearness[5] = 1.0F;
  buffer.reset(5, 2);
  EXPECT_EQ(buffer.depth.width, 5);
  EXPECT_EQ(buffer.depth.height, 2);
  EXPECT_EQ(buffer.items, std::vector<std::uint32_t>(10, no_item));
  EXPECT_EQ(buffer.depth.nearness, std::vector<float>(10, 0.0F));
}

}  // namespace
}  // namespace occlod
