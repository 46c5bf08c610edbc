// Triangles that reach behind the eye or far out of the image.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "occlod/view.h"
#include "raster/clip.h"
#include "raster/pixel_space.h"
#include "support/cameras.h"

namespace occlod {
namespace {

constexpr int width = 80;
constexpr int height = 60;
constexpr double near_distance = 0.5;

// At the origin, looking along -z; f = 30 px.
glm::mat4 to_clip() {
  Camera camera = test::origin_camera(width, height);
  camera.near = near_distance;
  camera.far = 1000.0;
  return ObjectView(View(camera), glm::dmat4(1.0)).object_to_clip();
}

// The floor y = -1 is met by the ray ((x - 39.5) / 30, (29.5 - y) / 30, -1) at depth 30 / (y - 29.5) where y > 29.5.
double floor_inverse_depth(int y) { return (y - 29.5) / 30.0; }

TEST(Clipping, AFloorThatReachesBehindTheEyeHasTheDepthOfItsPlane) {
  // One corner before the eye and two behind it, and two before and one behind. At the depths that the image shows (at
  // most 60, in row 30) the floor is more than a million units wide: every pixel below the horizon is covered and none
  // above.
  const std::vector<glm::vec3> p = {{0, -1, -1e6F},     {-4e6F, -1, 1e6F}, {4e6F, -1, 1e6F},
                                    {-4e6F, -1, -1e6F}, {4e6F, -1, -1e6F}, {0, -1, 4e6F}};
  for (const Triangle& triangle : {Triangle(0, 1, 2), Triangle(2, 1, 0), Triangle(3, 4, 5), Triangle(5, 3, 4)}) {
    DepthBuffer depth;
    depth.reset(width, height);
    draw_depth(depth, p, {&triangle, 1}, to_clip());
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const float drawn = depth.nearness[static_cast<std::size_t>(y * width + x)];
        // Snapping moves the plane by at most 1/512 px, of 1/30 a row each.
        EXPECT_NEAR(drawn, y < 30 ? 0.0 : floor_inverse_depth(y), y < 30 ? 0.0 : 1e-6 + 1.0 / 256 / 30)
            << x << "," << y;
      }
    }
  }
}

TEST(Clipping, EndsAtTheNearPlane) {
  // A floor at y = -0.3 is met at depth 9 / (y - 29.5), which is nearer than 0.5 below y = 47.5: rows from 48 on are
  // cut away.
  const std::vector<glm::vec3> p = {{-1000, -0.3F, -1000}, {1000, -0.3F, -1000}, {0, -0.3F, 1000}};
  const Triangle triangle(0, 1, 2);
  DepthBuffer depth;
  depth.reset(width, height);
  draw_depth(depth, p, {&triangle, 1}, to_clip());
  for (int x = 0; x < width; ++x) {
    EXPECT_EQ(depth.nearness[static_cast<std::size_t>(48 * width + x)], 0.0F);
    EXPECT_EQ(depth.nearness[static_cast<std::size_t>(59 * width + x)], 0.0F);
    EXPECT_NEAR(depth.nearness[static_cast<std::size_t>(46 * width + x)], 16.5 / 9.0, 2e-3);
    EXPECT_NEAR(depth.nearness[static_cast<std::size_t>(35 * width + x)], 5.5 / 9.0, 2e-3);
  }
}

// A tunnel of jittered quads around the eye and far behind it, closed at the end: whatever is clipped, each pixel has
// one owner.
TEST(Clipping, OpensNoCracksBetweenNeighbours) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> jitter(-0.2F, 0.2F);
  constexpr std::uint32_t sides = 7, rings = 6;
  std::vector<glm::vec3> p;
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double angle = 2.0 * M_PI * i / sides;
      p.emplace_back(3.0 * std::cos(angle) + jitter(random), 3.0 * std::sin(angle) + jitter(random),
                     4.0 - 4.0 * ring + jitter(random));
    }
  }
  const auto apex = static_cast<std::uint32_t>(p.size());
  p.emplace_back(0.1F, 0.2F, -18.0F);
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t next = (i + 1) % sides;
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
      triangles.emplace_back(ring * sides + i, ring * sides + next, (ring + 1) * sides + i);
      triangles.emplace_back((ring + 1) * sides + i, ring * sides + next, (ring + 1) * sides + next);
    }
    triangles.emplace_back((rings - 1) * sides + i, (rings - 1) * sides + next, apex);
  }
  // The tunnel is convex around the line of sight up to its jitter, which is too small to fold it as seen from the eye.
  for (const int count : test::count_coverage(p, triangles, to_clip(), width, height)) ASSERT_EQ(count, 1);
}

// Only bits that are equal stay equal through snapping: the corner made on an edge is the same for the triangle on its
// other side.
TEST(Clipping, MakesTheSameCornerFromBothSidesOfAnEdge) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> any(-3.0, 3.0), inside(0.1, 3.0), outside(-3.0, -0.1);
  for (int n = 0; n < 1000; ++n) {
    // z = distance - w: before the near plane where the distance is negative.
    const auto corner = [&](double distance) {
      const double w = inside(random) + 0.5;
      return glm::dvec4(0.1 * any(random), 0.1 * any(random), distance - w, w);
    };
    const glm::dvec4 a = corner(inside(random)), b = corner(outside(random)), c = corner(inside(random));
    const glm::dvec2 no_guard(1e9);
    const raster::ClipPolygon one = raster::clip_triangle({a, b, c}, no_guard);
    const raster::ClipPolygon other = raster::clip_triangle({b, a, c}, no_guard);
    if (one.size != 4 || other.size != 4) continue;  // cut by the near plane alone
    EXPECT_EQ(one.corners[1], other.corners[0]);     // a, ab, bc, c and ba, a, c, cb
  }
}

TEST(Clipping, HugeCoordinatesCoverWhatTheyShould) {
  for (const float huge : {1e6F, 1e15F, 1e30F, 3e38F}) {
    // In the plane z = -4: fills the image at depth 4. The upper half of it: ends at the horizon.
    const std::vector<glm::vec3> p = {{-huge, -huge, -4}, {huge, -huge, -4}, {0, huge, -4},
                                      {-huge, 0, -4},     {huge, 0, -4},     {0, huge, -4}};
    const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 4, 5}};
    DepthBuffer depth;
    depth.reset(width, height);
    draw_depth(depth, p, {&triangles[0], 1}, to_clip());
    for (const float z : depth.nearness) ASSERT_NEAR(z, 0.25F, 1e-6F) << huge;
    depth.reset(width, height);
    draw_depth(depth, p, {&triangles[1], 1}, to_clip());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        ASSERT_EQ(depth.nearness[static_cast<std::size_t>(y * width + x)] > 0.0F, y < 30)
            << huge << ": " << x << "," << y;
  }
}

TEST(Clipping, NothingBehindTheEyeIsDrawn) {
  const std::vector<glm::vec3> p = {{-5, -5, 4}, {5, -5, 4}, {0, 9, 4}, {-5, -5, -0.4F}, {5, -5, -0.4F}, {0, 9, -0.4F}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 4, 5}};  // behind the eye; between the eye and the near plane
  for (const int count : test::count_coverage(p, triangles, to_clip(), width, height)) EXPECT_EQ(count, 0);
}

}  // namespace
}  // namespace occlod
