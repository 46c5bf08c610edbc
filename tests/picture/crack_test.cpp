// Cracks in depth images made by hand, and in drawn meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <vector>

#include "occlod/compare.h"
#include "picture/quads.h"
#include "support/meshes.h"

namespace occlod {
namespace {

using test::front_view;
using test::parallel_view;

constexpr int width = 100, height = 80;
constexpr std::size_t rows = height - 2 * 3;  // that count: the outermost, and 2 beside them, may lie beside a step

// Columns [begin, end) get the nearness `inside`, the others `outside`.
DepthBuffer columns(int begin, int end, double inside, double outside) {
  DepthBuffer depth;
  depth.reset(width, height);
  for (int i = 0; i < width * height; ++i)
    depth.nearness[static_cast<std::size_t>(i)] =
        static_cast<float>(i % width >= begin && i % width < end ? inside : outside);
  return depth;
}

DepthBuffer flat(double nearness) { return columns(0, 0, 0.0, nearness); }

std::size_t cracks(const DepthBuffer& full, const DepthBuffer& found, double allowed_px = 1.0) {
  return count_crack_pixels(front_view(), full, found, allowed_px);
}

TEST(CountCrackPixels, OfAGapOneOrTwoPixelsWide) {
  for (const double behind : {0.0, 0.05}) {  // background, and a wall at twice the distance
    EXPECT_EQ(cracks(flat(0.1), columns(50, 51, behind, 0.1)), rows);
    EXPECT_EQ(cracks(flat(0.1), columns(50, 52, behind, 0.1)), 2U * rows);
    // A hole: only the pixels beside what is left of the surface are taken for cracks.
    EXPECT_EQ(cracks(flat(0.1), columns(50, 60, behind, 0.1)), 2U * rows);
  }
  EXPECT_EQ(cracks(flat(0.1), flat(0.1)), 0U);
  EXPECT_EQ(cracks(flat(0.1), flat(0.0)), 0U);  // all of it is missing: nothing that gapes
  EXPECT_EQ(cracks(flat(0.0), flat(0.1)), 0U);  // or too much is there
  EXPECT_EQ(cracks(flat(0.0), flat(0.0)), 0U);
}

TEST(CountCrackPixels, NotOfDepthThatMayDiffer) {
  // f = 40 px: 2 px at depth 10 are 0.5 units. A groove that deep, and a ridge of any height.
  EXPECT_EQ(cracks(flat(0.1), columns(50, 51, 1 / 10.45, 0.1), 2.0), 0U);
  EXPECT_EQ(cracks(flat(0.1), columns(50, 51, 1 / 10.55, 0.1), 2.0), rows);
  EXPECT_EQ(cracks(flat(0.1), columns(50, 51, 0.5, 0.1)), 0U);
  // The surface beside it may differ too.
  EXPECT_EQ(cracks(flat(0.1), columns(50, 51, 0.0, 1 / 10.45), 2.0), rows);
  EXPECT_EQ(cracks(flat(0.1), columns(50, 51, 0.0, 1 / 10.55), 2.0), 0U);
}

TEST(CountCrackPixels, OfParallelRays) {
  // 0.1 units cover a pixel anywhere; nearness falls by 0.01 for each unit.
  const auto count = [](double behind) {
    return count_crack_pixels(parallel_view(), flat(0.9), columns(50, 51, behind, 0.9), 2.0);
  };
  EXPECT_EQ(count(0.9 - 0.0019), 0U);
  EXPECT_EQ(count(0.9 - 0.0021), rows);
  EXPECT_EQ(count(0.0), rows);
}

TEST(CountCrackPixels, NotBesideAStepInDepth) {
  // Near left of column 50, far right of it: steps at columns 49 and 50. What looks like a gap there may be the step,
  // moved.
  const DepthBuffer full = columns(0, 50, 0.1, 0.05);
  const auto with_gap = [&](int column, double behind) {
    DepthBuffer found = full;
    for (int y = 0; y < height; ++y)
      found.nearness[static_cast<std::size_t>(y * width + column)] = static_cast<float>(behind);
    return cracks(full, found);
  };
  for (const double behind : {0.0, 0.05}) {
    EXPECT_EQ(with_gap(49, behind), 0U);
    EXPECT_EQ(with_gap(47, behind), 0U);
    EXPECT_EQ(with_gap(46, behind), rows);
  }
  EXPECT_EQ(with_gap(52, 0.0), 0U);
  EXPECT_EQ(with_gap(53, 0.0), rows);
}

// The outline of `full` may lie just outside the image, and that of `found` just inside.
TEST(CountCrackPixels, NotBesideTheBorder) {
  for (const int beside : {0, 1, 2}) {
    EXPECT_EQ(cracks(flat(0.1), columns(beside, beside + 1, 0.0, 0.1)), 0U);
    EXPECT_EQ(cracks(flat(0.1), columns(width - 1 - beside, width - beside, 0.0, 0.1)), 0U);
  }
  EXPECT_EQ(cracks(flat(0.1), columns(3, 4, 0.0, 0.1)), rows);
  EXPECT_EQ(cracks(flat(0.1), columns(width - 4, width - 3, 0.0, 0.1)), rows);
}

// A slope is no step, however steep: a plane that is 10 px deeper in each column.
TEST(CountCrackPixels, OnASlope) {
  DepthBuffer full = flat(0.1);
  for (int i = 0; i < width * height; ++i)
    full.nearness[static_cast<std::size_t>(i)] += 0.025F * static_cast<float>(i % width);
  DepthBuffer found = full;
  for (int y = 0; y < height; ++y) found.nearness[static_cast<std::size_t>(y * width + 50)] = 0.0F;
  EXPECT_EQ(cracks(full, found), rows);
}

// The plane z = -5, where a unit is 8 px. Its lower half is one quad; the upper one meets it in two edges, with a
// vertex in the middle that is `raised`.
DepthBuffer t_junction(float raised) {
  const std::vector<glm::vec3> positions = {{-4, -4, -5},        {4, -4, -5}, {4, 0, -5}, {-4, 0, -5},
                                            {0.25F, raised, -5}, {4, 4, -5},  {-4, 4, -5}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}, {3, 4, 6}, {4, 5, 6}, {4, 2, 5}};
  DepthBuffer depth;
  depth.reset(width, height);
  draw_depth(depth, positions, triangles, glm::mat4(front_view().world_to_clip()));
  return depth;
}

TEST(CountCrackPixels, OfATJunction) {
  EXPECT_EQ(cracks(t_junction(0.0F), t_junction(0.0F)), 0U);
  // Raised by 0.8 px, the triangle between the three edges holds the centres of the row above them, 0.5 px up, where it
  // is that high: from -4 + 0.625 * 4.25 to 4 - 0.625 * 3.75, which is from 39.25 to 63.25 px. 24 centres lie between.
  EXPECT_EQ(cracks(t_junction(0.0F), t_junction(0.1F)), 24U);
}

// From a distance of 3, where a unit of the unit sphere is at most 120 px: f is 240 px, and nothing is nearer than 2.
DepthBuffer draw(const View& view, const TriangleMesh& mesh) {
  DepthBuffer depth;
  depth.reset(view.width(), view.height());
  draw_depth(depth, mesh.positions, mesh.triangles, glm::mat4(view.world_to_clip()));
  return depth;
}

// Spread over the sphere by the golden angle.
View view_from(int i, int count) {
  Camera camera;
  const double z = 1.0 - (2.0 * i + 1.0) / count, angle = 2.399963229728653 * i;
  camera.eye = 3.0 * glm::dvec3(std::sqrt(1.0 - z * z) * std::cos(angle), std::sqrt(1.0 - z * z) * std::sin(angle), z);
  camera.up = {0.1, 1.0, 0.2};
  camera.fov_y_deg = 2.0 * glm::degrees(std::atan(0.5));
  camera.width = camera.height = 240;
  return View(camera);
}

// Every vertex moved by at most `distance` along the radius, each by another share of it.
TriangleMesh moved(TriangleMesh mesh, float distance) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    mesh.positions[i] *= 1.0F + distance * std::sin(static_cast<float>(i) * 12.9898F);
  return mesh;
}

// A surface that is closed has none, however coarse its errors, from anywhere.
TEST(CountCrackPixels, NoneOnAClosedMesh) {
  const TriangleMesh full = test::octahedron_sphere(5), found = moved(full, 1.0F / 120.0F);
  for (int i = 0; i < 100; ++i) {
    const View view = view_from(i, 100);
    EXPECT_EQ(count_crack_pixels(view, draw(view, full), draw(view, found), 1.0), 0U) << i;
  }
}

// The two halves of the sphere, cut at the equator and moved apart by a pixel and a half, gape in every view that does
// not look along the axis.
TEST(CountCrackPixels, SomeWhereAClosedMeshIsCut) {
  const TriangleMesh full = test::octahedron_sphere(5);
  TriangleMesh found;
  for (const float side : {-1.0F, 1.0F}) {
    TriangleMesh half = full;
    half.triangles.erase(
        std::remove_if(half.triangles.begin(), half.triangles.end(),
                       [&](const Triangle& t) {
                         return side * (full.positions[t.x].z + full.positions[t.y].z + full.positions[t.z].z) < 0.0F;
                       }),
        half.triangles.end());
    test::append(found, half, {0.0F, 0.0F, side * 0.75F / 120.0F});
  }
  for (int i = 20; i < 80; ++i) {
    const View view = view_from(i, 100);
    EXPECT_GT(count_crack_pixels(view, draw(view, full), draw(view, found), 1.0), 20U) << i;
  }
}

}  // namespace
}  // namespace occlod
