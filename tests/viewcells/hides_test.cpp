#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "cells/hull_test.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "oracle/random_shapes.h"
#include "oracle/ray_scene.h"
#include "support/holed_meshes.h"
#include "support/meshes.h"

namespace occlod {
namespace {

constexpr CellBox eyes{{-1, -1, -1}, {1, 1, 1}};
// The hull of both reaches to y, z = 2.1 at x = 10, along the line from (-1, 1) to (19, 3).
constexpr CellBox box{{19, -3, -3}, {21, 3, 3}};

struct Sheets {
  std::vector<glm::dvec3> positions;
  std::vector<Triangle> triangles;
  std::vector<float> moved;

  // A square across the x axis, of cells x cells squares, but for the cell (hole, hole).
  void add(double x, double half, int cells = 4, int hole = -1, float how_far = 0.0F) {
    const auto base = static_cast<VertexId>(positions.size()), row = static_cast<VertexId>(cells + 1);
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i)
        positions.emplace_back(x, half * (2.0 * i / cells - 1.0), half * (2.0 * j / cells - 1.0));
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i) {
        if (i == hole && j == hole) continue;
        const VertexId a = base + static_cast<VertexId>(j) * row + static_cast<VertexId>(i);
        triangles.insert(triangles.end(), {{a, a + 1, a + row + 1}, {a, a + row + 1, a + row}});
        moved.insert(moved.end(), {how_far, how_far});
      }
  }
};

bool hides(const Sheets& sheets, const CellBox& what = box, double near_reach = 0.0) {
  const CellSurface surface(sheets.positions, sheets.triangles, sheets.moved);
  HullTest test(surface);
  test.set_cell(eyes, near_reach);
  return test.hides(what);
}

Sheets square(double x, double half, int cells = 4, int hole = -1, float moved = 0.0F) {
  Sheets sheets;
  sheets.add(x, half, cells, hole, moved);
  return sheets;
}

TEST(HullTest, ASquareHidesIffItHoldsTheSection) {
  EXPECT_TRUE(hides(square(10, 2.11)));
  EXPECT_FALSE(hides(square(10, 2.09)));
  EXPECT_TRUE(hides(square(10, 2.11, 1)));  // of two triangles
  EXPECT_TRUE(hides(square(10, 2.11, 13)));
  EXPECT_FALSE(hides(square(10, 2.09, 13)));
}

// What stands for a square that has moved by 0.1 may end 0.1 before it does, and may be as much nearer or farther,
// where the hull is 0.01 wider.
TEST(HullTest, MotionGrowsTheHull) {
  EXPECT_TRUE(hides(square(10, 2.22, 4, -1, 0.1F)));
  EXPECT_FALSE(hides(square(10, 2.19, 4, -1, 0.1F)));
}

// ... and it must not reach into the cell or the box.
TEST(HullTest, MotionKeepsItsDistance) {
  EXPECT_TRUE(hides(square(1.11, 5, 4, -1, 0.1F)));
  EXPECT_FALSE(hides(square(1.09, 5, 4, -1, 0.1F)));
  EXPECT_TRUE(hides(square(18.89, 5, 4, -1, 0.1F)));
  EXPECT_FALSE(hides(square(18.91, 5, 4, -1, 0.1F)));
}

TEST(HullTest, NothingThatTouchesAnEndHides) {
  EXPECT_FALSE(hides(square(0.5, 50)));
  EXPECT_FALSE(hides(square(20, 50)));
  EXPECT_TRUE(hides(square(1.5, 50)));
}

// An eye at x = 1 clips what is nearer than 0.6.
TEST(HullTest, WhatIsClippedHidesNothing) {
  EXPECT_TRUE(hides(square(1.5, 5), box, 0.4));
  EXPECT_FALSE(hides(square(1.5, 5), box, 0.6));
}

TEST(HullTest, AWindowShowsWhatIsBehindIt) {
  EXPECT_TRUE(hides(square(10, 7, 7, 0)));   // it ends at -5
  EXPECT_FALSE(hides(square(10, 7, 7, 3)));  // from -1 to 1
  EXPECT_FALSE(hides(square(10, 7, 7, 2)));  // from -3 to -1: some eye sees some of the box
}

// Together they hide all of it; neither does alone. Only one connected surface is ever taken.
TEST(HullTest, TwoWallsWithWindowsArePassed) {
  Sheets two = square(9, 7, 7, 2);
  two.add(11, 7, 7, 4);
  EXPECT_FALSE(hides(two));
  two.add(12, 7);
  EXPECT_TRUE(hides(two));
}

TEST(HullTest, WhatIsBesideOrBehindDoesNotHide) {
  EXPECT_FALSE(hides(square(-5, 50)));
  EXPECT_FALSE(hides(square(25, 50)));
  EXPECT_FALSE(hides(Sheets{}));
}

// Its front is crossed once, its back once: the flood stays on one of them, as their common outline is beyond the hull.
TEST(HullTest, ASolidHides) {
  const TriangleMesh ball = test::octahedron_sphere(4);
  Sheets sheets;
  for (const glm::vec3& p : ball.positions) sheets.positions.push_back(5.0 * glm::dvec3(p) + glm::dvec3(10, 0, 0));
  sheets.triangles.assign(ball.triangles.begin(), ball.triangles.end());
  sheets.moved.assign(ball.triangles.size(), 0.0F);
  EXPECT_TRUE(hides(sheets));
  for (glm::dvec3& p : sheets.positions) p.y += 3.5;  // its outline, at about y = -1.5, is in the hull
  EXPECT_FALSE(hides(sheets));
}

// A sheet that is given once for each side is a sheet.
TEST(HullTest, DoubledSheetsHide) {
  Sheets doubled = square(10, 3);
  for (std::size_t i = 0, n = doubled.triangles.size(); i < n; ++i) {
    const Triangle t = doubled.triangles[i];
    doubled.triangles.push_back({t.y, t.x, t.z});
    doubled.moved.push_back(0.0F);
  }
  EXPECT_TRUE(hides(doubled));
}

// Three leaves at one edge: an odd number, wherever the third one leads.
TEST(HullTest, AnEdgeOfThreeIsABorder) {
  Sheets book = square(10, 3, 2);
  book.positions.emplace_back(15, 0, 0);
  // Vertices 4 and 5 lie in the middle and right of it, at z = 0.
  book.triangles.push_back({4, 5, static_cast<VertexId>(book.positions.size() - 1)});
  book.moved.push_back(0.0F);
  EXPECT_FALSE(hides(book));
}

TEST(HullTest, FlatCellsAndBoxesWork) {
  const Sheets wall = square(10, 3);
  const CellSurface surface(wall.positions, wall.triangles, wall.moved);
  HullTest test(surface);
  test.set_cell({glm::dvec3(0), glm::dvec3(0)}, 0.0);
  EXPECT_TRUE(test.hides({glm::dvec3(20, 0.7, 0.4), glm::dvec3(20, 0.7, 0.4)}));
  EXPECT_FALSE(test.hides({glm::dvec3(20, 7, 0), glm::dvec3(20, 7, 0)}));
  test.set_cell({{0, -1, -1}, {0, 1, 1}}, 0.0);
  EXPECT_TRUE(test.hides({{20, -1, -1}, {20, 1, 1}}));
}

// Of 5,800 triangles in the hull; one window, far from the middle, shows the box. A flood that ends early does not find
// it, and must not say that there is none.
TEST(HullTest, AFloodThatIsTooLongFails) {
  EXPECT_FALSE(hides(square(10, 2.5, 64, 8)));
  EXPECT_TRUE(hides(square(10, 2.5, 32)));
}

// The answer does not depend on what was remembered, but for the better.
TEST(HullTest, WhatHidIsRemembered) {
  const Sheets wall = square(10, 3);
  const CellSurface surface(wall.positions, wall.triangles, wall.moved);
  HullTest test(surface);
  test.set_cell(eyes, 0.0);
  EXPECT_TRUE(test.hides(box));
  EXPECT_EQ(test.counts().remembered, 0U);
  EXPECT_TRUE(test.hides({{20, 0, 0}, {21, 1, 1}}));
  EXPECT_EQ(test.counts().remembered, 1U);
  EXPECT_FALSE(test.hides({{20, 20, 0}, {21, 21, 1}}));
}

struct Count {
  int hidden = 0;  // boxes
  int wrong = 0;   // segments from the cell to such a box that the input does not stop
};

// Cells and boxes on either side of points of a mesh of about unit size. Segments go from any point of one to any of
// the other.
Count count_wrongly_hidden(const TriangleMesh& mesh, double max_motion) {
  const Hierarchy hierarchy = build_hierarchy(mesh);
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  const CellSurface surface(objects, max_motion);
  const test::RayScene input(mesh.positions, mesh.triangles);
  HullTest test(surface);
  test::RandomShapes random(11);
  const auto around = [](const glm::dvec3& p, double half) { return CellBox{p - half, p + half}; };
  const auto any = [&](const CellBox& in) {
    return glm::mix(in.min, in.max, glm::dvec3(random.in(0, 1), random.in(0, 1), random.in(0, 1)));
  };
  Count count;
  for (int n = 0; n < 12'000; ++n) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(random.below(static_cast<int>(mesh.triangles.size())))];
    const glm::dvec3 p = glm::dvec3(mesh.positions[t.x]) + random.point(0.02), direction = random.unit();
    const CellBox cell = around(p + random.in(0.2, 1.5) * direction, random.in(0.0, 0.03));
    const CellBox what = around(p - random.in(0.05, 1.0) * direction, random.in(0.0, 0.03));
    test.set_cell(cell, 0.0);
    if (!test.hides(what)) continue;
    ++count.hidden;
    for (int k = 0; k < 30; ++k) {
      const glm::dvec3 from = any(cell), to = any(what);
      count.wrong += input.first_hit(from, to - from) < 1.0 ? 0 : 1;
    }
  }
  return count;
}

void expect_conservative(const TriangleMesh& mesh, double max_motion, int min_hidden) {
  const Count count = count_wrongly_hidden(mesh, max_motion);
  EXPECT_EQ(count.wrong, 0);
  EXPECT_GT(count.hidden, min_hidden);
}

TEST(CellOccluders, Input) {
  expect_conservative(test::noisy_sphere(4, 6), 0.0, 3000);
  expect_conservative(test::sheet_with_windows(), 0.0, 500);
}
TEST(CellOccluders, Ball) { expect_conservative(test::noisy_sphere(4, 6), 0.05, 2000); }
TEST(CellOccluders, Pipes) {
  TriangleMesh mesh = generate("pipes", {{"pipes", 40}, {"bends", 8}, {"sides", 8}});
  for (glm::vec3& p : mesh.positions) p = 2.0F * p - 1.0F;
  expect_conservative(mesh, 0.01, 300);
}
TEST(CellOccluders, SheetWithWindows) { expect_conservative(test::sheet_with_windows(), 0.03, 200); }
// Where all of them would close, if nothing held them open: see AreWrongWhereTopologyChanges.
TEST(CellOccluders, SheetWithWindowsThatMayClose) { expect_conservative(test::sheet_with_windows(), 0.05, 100); }
TEST(CellOccluders, BlockWithTunnels) { expect_conservative(test::block(true), 0.02, 500); }
TEST(CellOccluders, BlockWithGrooves) { expect_conservative(test::block(false), 0.05, 500); }
TEST(CellOccluders, MoebiusBand) { expect_conservative(test::moebius(64), 0.02, 100); }

// Without an inside, and it meets itself: its figure of eight turns by half on the way round.
TEST(CellOccluders, KleinBottle) {
  constexpr std::uint32_t around = 48, across = 24;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2.0 * std::numbers::pi * i / around, v = 2.0 * std::numbers::pi * j / across;
      const double r = 0.7 + 0.3 * (std::cos(u / 2) * std::sin(v) - std::sin(u / 2) * std::sin(2 * v));
      mesh.positions.emplace_back(r * std::cos(u), r * std::sin(u),
                                  0.3 * (std::sin(u / 2) * std::sin(v) + std::cos(u / 2) * std::sin(2 * v)));
    }
  const auto at = [](std::uint32_t i, std::uint32_t j) {  // going round turns v into -v
    const std::uint32_t turned = i == around ? (across - j % across) % across : j % across;
    return i % around * across + turned;
  };
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  expect_conservative(mesh, 0.02, 200);
}

// Three sheets at one edge, and a fourth that lies on one of them.
TEST(CellOccluders, SheetsAtAnEdge) {
  TriangleMesh mesh;
  constexpr VertexId n = 12;
  for (int leaf = 0; leaf < 3; ++leaf)
    for (VertexId j = 0; j <= n; ++j)
      for (VertexId i = leaf == 0 ? 0 : 1; i <= n; ++i) {
        const double angle = 2.0 * std::numbers::pi * leaf / 3, r = 1.0 * i / n;
        mesh.positions.emplace_back(r * std::cos(angle), r * std::sin(angle), 2.0 * j / n - 1.0);
      }
  const auto at = [](int leaf, VertexId i, VertexId j) {
    if (i == 0 || leaf == 0) return j * (n + 1) + i;
    return (n + 1) * (n + 1) + static_cast<VertexId>(leaf - 1) * n * (n + 1) + j * n + i - 1;
  };
  for (const int leaf : {0, 1, 2, 2})
    for (VertexId j = 0; j < n; ++j)
      for (VertexId i = 0; i < n; ++i) {
        mesh.triangles.emplace_back(at(leaf, i, j), at(leaf, i + 1, j), at(leaf, i + 1, j + 1));
        mesh.triangles.emplace_back(at(leaf, i, j), at(leaf, i + 1, j + 1), at(leaf, i, j + 1));
      }
  expect_conservative(mesh, 0.02, 200);
}
TEST(CellOccluders, Soup) {
  TriangleMesh mesh;
  test::RandomShapes random(1);
  for (std::uint32_t i = 0; i < 60; ++i) {
    const glm::dvec3 center = random.point(1.0);
    for (int k = 0; k < 3; ++k) mesh.positions.emplace_back(center + random.point(0.6));
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  expect_conservative(mesh, 0.1, 1000);
}

}  // namespace
}  // namespace occlod
