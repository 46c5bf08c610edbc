// Guards of the hull test and of occluders that no other scene needs: each of these has one right answer, and is wrong
// as soon as the guard is left out.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>
#include <vector>

#include "cell_sight.h"
#include "hierarchy/motion_cut.h"
#include "occlod/hierarchy/build.h"
#include "support/meshes.h"
#include "viewcells/hull_test.h"

namespace occlod {
namespace {

constexpr CellBox eyes{{-1, -1, -1}, {1, 1, 1}};
constexpr CellBox box{{19, -3, -3}, {21, 3, 3}};

// A sheet over y from `first` to `last` and z from -8 to 8, where x = `at` + `slope` y.
struct Sheet {
  double at = 0.0, slope = 0.0, first = -8.0, last = 8.0;
  float moved = 0.0F;
};

bool hides(std::vector<glm::dvec3> positions, const std::vector<Triangle>& triangles, const std::vector<float>& moved) {
  const CellSurface surface(std::move(positions), triangles, moved);
  HullTest test(surface);
  test.set_cell(eyes, 0.0);
  return test.hides(box);
}

// Sheets that end where the next one begins share the vertices there. `cells`: squares of each along y, and along z.
bool hides(const std::vector<Sheet>& sheets, VertexId cells = 8) {
  std::vector<glm::dvec3> positions;
  std::vector<Triangle> triangles;
  std::vector<float> moved;
  const auto add_column = [&](const Sheet& sheet, double y) {
    for (VertexId k = 0; k <= cells; ++k) positions.emplace_back(sheet.at + sheet.slope * y, y, 16.0 * k / cells - 8.0);
  };
  add_column(sheets[0], sheets[0].first);
  for (const Sheet& sheet : sheets)
    for (VertexId i = 1; i <= cells; ++i) {
      const auto left = static_cast<VertexId>(positions.size()) - cells - 1, right = left + cells + 1;
      add_column(sheet, sheet.first + (sheet.last - sheet.first) * i / cells);
      for (VertexId k = 0; k < cells; ++k) {
        triangles.insert(triangles.end(),
                         {{left + k, right + k, right + k + 1}, {left + k, right + k + 1, left + k + 1}});
        moved.insert(moved.end(), {sheet.moved, sheet.moved});
      }
    }
  return hides(std::move(positions), triangles, moved);
}

// From middle to middle it is crossed at x = 16. But at y = 3 it is at x = 19.6, in the box: the corner (19, 3, z) is
// before it, and every eye sees that. No segment that is tried comes near: they end at y = 2.3 or before.
TEST(HullGuards, WhatReachesIntoTheBoxFurtherOnDoesNotHide) {
  EXPECT_FALSE(hides({{.at = 16.0, .slope = 1.2}}, 64));
  EXPECT_TRUE(hides({{.at = 16.0, .slope = 0.9}}, 64));  // at y = 3 it is at 18.7
}

// From middle to middle it is crossed at x = 4.45. But at y = -1 it is at x = 0.95, in the cell: an eye at (1, -1, z)
// is behind it, as all of the box is. The segment that comes nearest begins at y = -0.86 and crosses it at -0.83.
TEST(HullGuards, WhatReachesIntoTheCellFurtherOnDoesNotHide) {
  EXPECT_FALSE(hides({{.at = 4.45, .slope = 3.5}}, 160));
  EXPECT_TRUE(hides({{.at = 4.55, .slope = 3.5}}, 160));  // at y = -1 it is at 1.05
}

// Three pages of a book, open to y = 8, whose spine is at (10, -1, z). Whatever an eye sees past the spine it sees; a
// segment through the pages meets three, an odd number, and the spine is the border that it goes round.
TEST(HullGuards, ThreePagesHideNothingBesideTheirSpine) {
  std::vector<glm::dvec3> positions;
  for (const double z : {-8.0, 8.0}) {
    positions.emplace_back(10.0, -1.0, z);
    for (const double x : {7.0, 10.0, 13.0}) positions.emplace_back(x, 8.0, z);
  }
  std::vector<Triangle> triangles;
  for (const VertexId page : {1U, 2U, 3U}) triangles.insert(triangles.end(), {{0, page, page + 4}, {0, page + 4, 4}});
  EXPECT_FALSE(hides(positions, triangles, {}));
}

// Of 23,000 triangles in the hull. The window, at y = z = -2.0 in a hull that ends at -2.1, is far beyond the 4,096
// that are looked at from the middle on: that none of those is a border says nothing.
TEST(HullGuards, AFloodThatIsCutOffHidesNothing) {
  constexpr VertexId cells = 128, window = 12;
  std::vector<glm::dvec3> positions;
  std::vector<Triangle> triangles;
  for (VertexId j = 0; j <= cells; ++j)
    for (VertexId i = 0; i <= cells; ++i) positions.emplace_back(10.0, 5.0 * i / cells - 2.5, 5.0 * j / cells - 2.5);
  for (VertexId j = 0; j < cells; ++j)
    for (VertexId i = 0; i < cells; ++i) {
      const VertexId a = j * (cells + 1) + i, b = a + cells + 1;
      if (i != window || j != window) triangles.insert(triangles.end(), {{a, a + 1, b + 1}, {a, b + 1, b}});
    }
  EXPECT_FALSE(hides(positions, triangles, {}));
}

// The hull reaches to y = 2.1 at x = 10. A sheet that has not moved goes on at y = 2.3 as one that ends at 2.5. If that
// has moved by 0.5, so may the edge of both have; the input may end at y = 2.0, and what is behind shows past it.
TEST(HullGuards, AnEdgeHasMovedAsFarAsTheFartherOfItsTriangles) {
  const Sheet still{.at = 10.0, .last = 2.3}, rest{.at = 10.0, .first = 2.3, .last = 2.5};
  Sheet little = rest, far = rest;
  little.moved = 0.1F;
  far.moved = 0.5F;
  EXPECT_TRUE(hides({still, rest}));
  EXPECT_TRUE(hides({still, little}));
  EXPECT_FALSE(hides({still, far}));
}

// What has moved by m in an object three times as large has moved by 3 m in the world, and no float below that will do.
TEST(OccluderGuards, MotionsAreWorldUnitsAndRoundedUp) {
  const Hierarchy ball = build_hierarchy(test::noisy_sphere(4, 6));
  const MotionCut cut = cut_to_motion(ball, 0.15 / 3.0);
  const RefineObject objects[] = {{&ball, glm::scale(glm::dmat4(1.0), glm::dvec3(3.0))}};
  const CellSurface surface(objects, 0.15, {});
  ASSERT_EQ(surface.triangle_count(), cut.triangles.size());
  std::vector<double> expected, found;
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t) {
    expected.push_back(3.0 * static_cast<double>(cut.moved[t]));
    found.push_back(surface.moved(t));
  }
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_GE(found[i], expected[i]);
    EXPECT_LE(found[i], expected[i] * (1.0 + 1e-6));
  }
  EXPECT_GT(found.back(), 0.1);
}

// The ball's triangles that are drawn behind a wall at this distance from the cell. The near plane is at 0.2, in images
// whose corners are at 54.7 degrees: what is up to 0.2 * sqrt(3) = 0.346 away may lie before it there.
std::size_t drawn_behind_a_wall_at(double distance) {
  TriangleMesh mesh = test::grid(4, 4);
  for (glm::vec3& p : mesh.positions) p = {200.0F * p.x - 100.0F, 200.0F * p.y - 100.0F, 2.0F};
  const Hierarchy wall = build_hierarchy(mesh), ball = build_hierarchy(test::noisy_sphere(3, 1));
  const RefineObject objects[] = {{&ball}, {&wall, glm::dmat4(1.0), true}};
  const CellOccluders occluders(objects, 0.0);
  CellBuilder builder(objects, &occluders, {.eyes = tool::cube_eyes(128, 0.2)});
  const glm::dvec3 eye(0.0, 0.0, 2.0 + distance);
  return builder.build({eye, eye}).objects[0].triangles.size();
}

// Whether an eye there sees the ball in a corner of an image that looks along the diagonal of a cube.
bool sees_past_a_wall_at(double distance) {
  TriangleMesh mesh = test::grid(4, 4);
  for (glm::vec3& p : mesh.positions) p = {200.0F * p.x - 100.0F, 200.0F * p.y - 100.0F, 2.0F};
  const Hierarchy wall = build_hierarchy(mesh), ball = build_hierarchy(test::noisy_sphere(3, 1));
  const RefineObject objects[] = {{&ball}, {&wall, glm::dmat4(1.0), true}};
  const glm::dvec3 ahead = glm::normalize(glm::dvec3(1, 1, -1)), down(0, 0, -1);
  const glm::dvec3 side = glm::normalize(down - glm::dot(down, ahead) * ahead);
  Camera camera{{0.0, 0.0, 2.0 + distance}, {}, side + glm::cross(ahead, side)};
  camera.target = camera.eye + ahead;
  camera.fov_y_deg = 90.0;
  camera.width = camera.height = 256;
  camera.near = 0.2;
  camera.far = 100.0;
  const tool::FullScene full(objects);
  ItemBuffer items;
  full.draw(items, View(camera));
  return std::any_of(items.items.begin(), items.items.end(),
                     [&](std::uint32_t item) { return item != no_item && full.item(item).object == 0; });
}

TEST(CellGuards, TheNearPlaneIsFartherInTheCorners) {
  EXPECT_TRUE(sees_past_a_wall_at(0.3));
  EXPECT_GT(drawn_behind_a_wall_at(0.3), 0U);
  EXPECT_FALSE(sees_past_a_wall_at(0.36));
  EXPECT_EQ(drawn_behind_a_wall_at(0.36), 0U);
}

}  // namespace
}  // namespace occlod
