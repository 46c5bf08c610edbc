#include "support/guided_sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "occlod/mesh.h"

namespace occlod::bench {
namespace {

constexpr CellBox unit_cell{{0, 0, 0}, {1, 1, 1}};

// Across x: two triangles.
void add_quad(TriangleMesh& mesh, float x, const glm::vec2& low, const glm::vec2& high) {
  const auto first = static_cast<VertexId>(mesh.positions.size());
  for (const glm::vec2 p : {low, glm::vec2(high.x, low.y), high, glm::vec2(low.x, high.y)})
    mesh.positions.emplace_back(x, p.x, p.y);
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first, first + 2, first + 3);
}

std::set<std::uint32_t> found_in(const TriangleMesh& mesh, const GuidedOptions& options) {
  const test::RayScene scene(mesh.positions, mesh.triangles);
  GuidedSampling sampling(mesh.positions, mesh.triangles, scene, unit_cell, options);
  std::set<std::uint32_t> triangles;
  std::uint64_t rays = 0;
  for (const FoundTriangle& found : sampling.run()) {
    EXPECT_TRUE(triangles.insert(found.triangle).second) << "found twice: " << found.triangle;
    EXPECT_LE(rays, found.rays);
    rays = found.rays;
  }
  EXPECT_LE(rays, sampling.rays());
  return triangles;
}

// A segment from the cell to the second quad crosses x = 2 between y and z of both its ends, hence in the wall.
TEST(GuidedSampling, FindsWhatIsSeenAndNothingElse) {
  TriangleMesh mesh;
  add_quad(mesh, 2.0F, {-3, -3}, {4, 4});
  add_quad(mesh, 2.5F, {0.4F, 0.4F}, {0.6F, 0.6F});
  add_quad(mesh, 2.5F, {10, 0}, {11, 1});
  for (const bool guided : {true, false})
    EXPECT_EQ(found_in(mesh, {.guided = guided, .max_ms = 1e9, .max_rays = 200'000}),
              (std::set<std::uint32_t>{0, 1, 4, 5}));
}

// 500 squares of 0.02 in a row at a distance of 19 to 20. A line through the cell, all equally likely, hits it with a
// probability of at most 10 * 0.02 * 1 / 19^2 (the lines through both areas) over pi * 6 (those through the cell): 29
// of a million. Once one is found, each finds its neighbours, which are as near as the border stands out.
TEST(GuidedSampling, FollowsWhatItHasFound) {
  TriangleMesh mesh;
  for (int i = 0; i < 500; ++i) {
    const float y = -5.0F + 0.02F * static_cast<float>(i);
    add_quad(mesh, 20.0F, {y, 0.5F}, {y + 0.02F, 0.52F});
  }
  EXPECT_EQ(found_in(mesh, {.guided = true, .max_ms = 1e9, .max_rays = 1'000'000}).size(), 1000U);
  const std::size_t by_chance = found_in(mesh, {.guided = false, .max_ms = 1e9, .max_rays = 1'000'000}).size();
  EXPECT_GT(by_chance, 0U);
  EXPECT_LT(by_chance, 60U);
}

// Two walls leave a slit of 0.012 in front of 600 posts of 0.002. All are seen from somewhere: y beyond the slit is 0.5
// + 5/4 (0.5 - y of the eye). From one place only some 13 are, and lines through slit and posts are 0.012 * 1.2 / 5^2
// over pi * 6 of all: 9 of 300,000. So without looking past the walls at most about 9 * 13 posts are found.
TEST(GuidedSampling, LooksPastWhatHides) {
  TriangleMesh mesh;
  add_quad(mesh, 5.0F, {-20, -20}, {0.494F, 21});
  add_quad(mesh, 5.0F, {0.506F, -20}, {21, 21});
  for (int i = 0; i < 600; ++i) {
    const float y = -0.1F + 0.002F * static_cast<float>(i);
    add_quad(mesh, 10.0F, {y, 0}, {y + 0.002F, 1});
  }
  GuidedOptions options{.guided = true, .max_ms = 1e9, .max_rays = 300'000};
  EXPECT_GT(found_in(mesh, options).size(), 1000U);
  options.jump = 1.0;  // nothing is so much nearer than the border
  EXPECT_LT(found_in(mesh, options).size(), 500U);
}

}  // namespace
}  // namespace occlod::bench
