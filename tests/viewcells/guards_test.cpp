// Guards of the hull test and of occluders that no other scene needs: each of these has one right answer, and is wrong
// as soon as the guard is left out.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>
#include <vector>

#include "cell_sight.h"
#include "cells/cell_geometry.h"
#include "cells/hull_test.h"
#include "cells/inner_boxes.h"
#include "occlod/build_hierarchy.h"
#include "splits/surface_motion.h"
#include "support/meshes.h"

namespace occlod {
namespace {

constexpr CellBox eyes{{-1, -1, -1}, {1, 1, 1}};
constexpr CellBox box{{19, -3, -3}, {21, 3, 3}};

// A sheet over y from `first` to `last` and z from -8 to 8, where x = `at` + `slope` y, but for one vertex, if it has
// any at that y and z.
struct Sheet {
  double at = 0.0, slope = 0.0, first = -8.0, last = 8.0;
  float moved = 0.0F;
  glm::dvec3 spike{0.0, 99.0, 99.0};
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
    for (VertexId k = 0; k <= cells; ++k) {
      const double z = 16.0 * k / cells - 8.0;
      positions.emplace_back(y == sheet.spike.y && z == sheet.spike.z ? sheet.spike.x : sheet.at + sheet.slope * y, y,
                             z);
    }
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

// A sheet at x = 16 with a hollow spike, 0.5 wide, into the box at y = -1.5, z = -1.75. Eyes see the bottom of it,
// which lies in the box: from (1, -1, z) at x = 19.2 it is 0.03 wide, and the line of sight 0.006 beside its axis. No
// segment that is tried comes near.
TEST(HullGuards, WhatReachesIntoTheBoxByASpikeDoesNotHide) {
  EXPECT_FALSE(hides({{.at = 16.0, .spike = {19.5, -1.5, -1.75}}}, 64));
  EXPECT_TRUE(hides({{.at = 16.0, .spike = {18.9, -1.5, -1.75}}}, 64));
}

// A sheet at x = 4 with one into the cell: an eye in it sees all that is straight before it.
TEST(HullGuards, WhatReachesIntoTheCellByASpikeDoesNotHide) {
  EXPECT_FALSE(hides({{.at = 4.0, .spike = {0.5, 0.0, -0.75}}}, 64));
  EXPECT_TRUE(hides({{.at = 4.0, .spike = {1.1, 0.0, -0.75}}}, 64));
}

struct Mesh {
  std::vector<glm::dvec3> positions;
  std::vector<Triangle> triangles;
};

// A wall at x = 10, to 2.5 in y and z, of cells x cells squares. The square (window, window) is missing.
Mesh wall_with_window(VertexId cells, VertexId window) {
  Mesh mesh;
  for (VertexId j = 0; j <= cells; ++j)
    for (VertexId i = 0; i <= cells; ++i)
      mesh.positions.emplace_back(10.0, 5.0 * i / cells - 2.5, 5.0 * j / cells - 2.5);
  for (VertexId j = 0; j < cells; ++j)
    for (VertexId i = 0; i < cells; ++i) {
      const VertexId a = j * (cells + 1) + i, b = a + cells + 1;
      if (i != window || j != window) mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, b + 1}, {a, b + 1, b}});
    }
  return mesh;
}

// From 1.25 to 1.5 in y and z, in a hull that ends at 2.1: some eye sees some of the box through it. No segment that is
// tried comes near: they are at (0, 0), (-0.2, 0.1), (0.4, -0.2), (-0.8, 0.8), (1.4, -1.4), (0.5, 1.1), (-0.8, 0.1),
// (-0.4, 1.0) there, and those between corners at about 1.9 and 2.1.
TEST(HullGuards, AWindowThatNoSegmentPassesShowsWhatIsBehindIt) {
  const Mesh wall = wall_with_window(20, 15), closed = wall_with_window(20, 20);
  EXPECT_FALSE(hides(wall.positions, wall.triangles, {}));
  EXPECT_TRUE(hides(closed.positions, closed.triangles, {}));
}

// The same window with a hollow frame around it: three triangles at each edge of the window, two elsewhere. It is as
// open as before, and an odd number of triangles is a border.
TEST(HullGuards, AFramedWindowShowsWhatIsBehindIt) {
  Mesh wall = wall_with_window(20, 15);
  const VertexId a = 15 * 21 + 15, first = static_cast<VertexId>(wall.positions.size());
  const std::array<VertexId, 4> rim = {a, a + 1, a + 22, a + 21};
  for (const VertexId v : rim) wall.positions.push_back(wall.positions[v] + glm::dvec3(0.3, 0, 0));
  const glm::dvec3 middle = 0.5 * (wall.positions[rim[0]] + wall.positions[rim[2]]);
  for (const VertexId v : rim) {  // the outside of the frame
    const glm::dvec3 outwards = glm::normalize(wall.positions[v] - middle);
    wall.positions.push_back(wall.positions[v] + glm::dvec3(0.15, 0, 0) + 0.05 * outwards);
  }
  for (VertexId k = 0; k < 4; ++k) {
    const VertexId next = (k + 1) % 4;
    const auto side = [&](VertexId p, VertexId q, VertexId r, VertexId s) {
      wall.triangles.insert(wall.triangles.end(), {{p, q, r}, {p, r, s}});
    };
    side(rim[k], rim[next], first + next, first + k);
    side(rim[k], rim[next], first + 4 + next, first + 4 + k);
    side(first + 4 + k, first + 4 + next, first + next, first + k);
  }
  EXPECT_FALSE(hides(wall.positions, wall.triangles, {}));
}

// Two such walls and a tunnel from window to window: no border at all, and each eye that sees through the windows sees
// through the tunnel. A flood comes to the other wall by way of it, and every segment that is tried meets both.
TEST(HullGuards, ATunnelIsOpen) {
  Mesh walls = wall_with_window(20, 15);
  const auto count = static_cast<VertexId>(walls.positions.size());
  for (VertexId v = 0; v < count; ++v) walls.positions.push_back(walls.positions[v] + glm::dvec3(0.5, 0, 0));
  for (std::size_t i = 0, n = walls.triangles.size(); i < n; ++i) {
    const Triangle t = walls.triangles[i];
    walls.triangles.emplace_back(t.x + count, t.y + count, t.z + count);
  }
  const VertexId a = 15 * 21 + 15;
  const std::array<VertexId, 4> rim = {a, a + 1, a + 22, a + 21};
  for (std::size_t k = 0; k < 4; ++k) {
    const VertexId p = rim[k], q = rim[(k + 1) % 4];
    walls.triangles.insert(walls.triangles.end(), {{p, q, q + count}, {p, q + count, p + count}});
  }
  EXPECT_FALSE(hides(walls.positions, walls.triangles, {}));
}

// Of 23,000 triangles in the hull. The window, at y = z = -2.0 in a hull that ends at -2.1, is far beyond the
// 16,384 that are looked at from the middle on: that none of those is a border says nothing.
TEST(HullGuards, AFloodThatIsCutOffHidesNothing) {
  const Mesh wall = wall_with_window(128, 12);
  EXPECT_FALSE(hides(wall.positions, wall.triangles, {}));
}

// A sheet at x = 16 goes on, at y = 1.5, to one at x = 10 that ends at y = -1. The flood from there fails at once; that
// from the other comes to it by the side, and would be without a border if it ended there.
TEST(HullGuards, AFloodThatMeetsAFailedOneFails) {
  std::vector<glm::dvec3> positions = {{10, -1, -8},  {10, -1, 8},  {10, 1.5, -8}, {10, 1.5, 8},
                                       {16, 1.5, -8}, {16, 1.5, 8}, {16, -8, -8},  {16, -8, 8}};
  std::vector<Triangle> triangles = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}, {4, 5, 7}, {4, 7, 6}};
  for (const double z : {-2.0, 2.0}) {  // on the segments from corner to corner
    const auto first = static_cast<VertexId>(positions.size());
    positions.insert(positions.end(), {{10, 1.7, z - 0.3}, {10, 2.3, z - 0.3}, {10, 2.0, z + 0.5}});
    triangles.emplace_back(first, first + 1, first + 2);
  }
  EXPECT_FALSE(hides(std::move(positions), triangles, {}));
}

// Many open triangles before a wall, all crossed by the segment from middle to middle, hide nothing themselves.
TEST(HullTest, AWallHidesBehindManySmallThings) {
  Mesh wall{{{16, -8, -8}, {16, 9, -8}, {16, 9, 8}, {16, -8, 8}}, {{0, 1, 2}, {0, 2, 3}}};
  for (int i = 0; i < 40; ++i) {
    const auto first = static_cast<VertexId>(wall.positions.size());
    const double x = 3.0 + 0.25 * i;
    wall.positions.insert(wall.positions.end(), {{x, -0.1, -0.1}, {x, 0.1, -0.1}, {x, 0.0, 0.2}});
    wall.triangles.emplace_back(first, first + 1, first + 2);
  }
  EXPECT_TRUE(hides(wall.positions, wall.triangles, {}));
}

// A ball that the hull holds is crossed twice by the segment from middle to middle. The others meet small triangles.
TEST(HullTest, AFloodEndsWhereItsPartIsCrossedAnEvenNumberOfTimes) {
  const TriangleMesh ball = test::octahedron_sphere(4);
  std::vector<glm::dvec3> positions;
  for (const glm::vec3& p : ball.positions) positions.push_back(1.5 * glm::dvec3(p) + glm::dvec3(10, 0.01, 0.02));
  std::vector<Triangle> triangles = ball.triangles;
  for (const double y : {-2.0, 2.0})
    for (const double z : {-2.0, 2.0}) {
      const auto first = static_cast<VertexId>(positions.size());
      positions.insert(positions.end(), {{10, y - 0.3, z - 0.3}, {10, y + 0.3, z - 0.3}, {10, y, z + 0.5}});
      triangles.emplace_back(first, first + 1, first + 2);
    }
  const CellSurface surface(std::move(positions), triangles, {});
  const InnerBoxes boxes(surface);
  HullTest whole(surface), early(surface, &boxes);
  for (HullTest* test : {&whole, &early}) {
    test->set_cell(eyes, 0.0);
    EXPECT_FALSE(test->hides(box));
    EXPECT_EQ(test->counts().free, 0U);
  }
  EXPECT_EQ(whole.counts().triangles, ball.triangles.size());
  EXPECT_LT(10 * early.counts().triangles, whole.counts().triangles);
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

// A block whose front is half open: one of its two triangles is missing, and eyes see what is inside it through that.
// The first segment that is tried meets the other, at y = -0.3, z = 0.2, and no more: an odd number.
TEST(BoxGuards, ABlockThatIsOpenInPartHidesNothing) {
  const CellBox block{{9, -2.5, -2.5}, {13, 2.5, 2.5}};
  std::vector<glm::dvec3> positions;
  for (std::size_t k = 0; k < 8; ++k) positions.push_back(corner_of(block, k));
  std::vector<Triangle> triangles = {{0, 4, 6}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4}, {2, 6, 7},
                                     {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  const auto hidden = [&] {
    const CellSurface surface(positions, triangles, {});
    const InnerBoxes boxes(surface);
    EXPECT_GT(boxes.boxes().size(), 0U);
    InnerBoxTest test(surface, boxes);
    test.set_cell(eyes, 0.0);
    return test.hides(box, 0);
  };
  EXPECT_FALSE(hidden());
  triangles.emplace_back(0, 6, 2);
  EXPECT_TRUE(hidden());
}

// What has moved by m in an object three times as large has moved by 3 m in the world, and no float below that will do.
TEST(OccluderGuards, MotionsAreWorldUnitsAndRoundedUp) {
  const Hierarchy ball = build_hierarchy(test::noisy_sphere(4, 6));
  const MotionCut cut = cut_to_motion(ball, 0.15 / 3.0);
  const RefineObject objects[] = {{&ball, glm::scale(glm::dmat4(1.0), glm::dvec3(3.0))}};
  const CellSurface surface(objects, 0.15);
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
