#include "cells/inner_boxes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "cells/cell_geometry.h"
#include "cells/hull_test.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "oracle/random_shapes.h"
#include "oracle/ray_scene.h"
#include "support/holed_meshes.h"
#include "support/meshes.h"

namespace occlod {
namespace {

bool is_free(const VoxelGrid& grid, const std::vector<std::uint8_t>& given, const VoxelGrid::Place& first,
             const VoxelGrid::Place& end) {
  for (int z = first[2]; z < end[2]; ++z)
    for (int y = first[1]; y < end[1]; ++y)
      for (int x = first[0]; x < end[0]; ++x)
        if (grid.is_taken({x, y, z}) ||
            (!given.empty() && given[static_cast<std::size_t>((z * grid.size()[1] + y) * grid.size()[0] + x)] != 0))
          return false;
  return true;
}

// Of all cubes, tried one by one.
int largest_edge(const VoxelGrid& grid, const std::vector<std::uint8_t>& given) {
  const auto& [nx, ny, nz] = grid.size();
  int most = 0;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x)
        for (int e = most + 1; x + e <= nx && y + e <= ny && z + e <= nz; ++e) {
          if (!is_free(grid, given, {x, y, z}, {x + e, y + e, z + e})) break;
          most = e;
        }
  return most;
}

TEST(VoxelGrid, BlocksHoldTheLargestFreeCubeAndCannotGrow) {
  test::RandomShapes random(3);
  VoxelGrid grid;
  for (int n = 0; n < 40; ++n) {
    grid.resize({6 + random.below(4), 5 + random.below(4), 4 + random.below(4)});
    const auto& [nx, ny, nz] = grid.size();
    for (int k = random.below(30); k >= 0; --k) grid.take({random.below(nx), random.below(ny), random.below(nz)});
    std::vector<std::uint8_t> given(static_cast<std::size_t>(nx * ny * nz), 0);
    for (int i = 0; i < 5; ++i) {
      const int edge = largest_edge(grid, given);
      const auto block = grid.next_block();
      ASSERT_EQ(block.has_value(), edge > 0);
      if (!block) break;
      ASSERT_TRUE(is_free(grid, {}, block->first, block->end));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_GE(block->end[axis] - block->first[axis], edge);
        VoxelGrid::Block before = *block, after = *block;
        before.end[axis] = before.first[axis]--;
        after.first[axis] = after.end[axis]++;
        EXPECT_TRUE(before.first[axis] < 0 || !is_free(grid, {}, before.first, before.end));
        EXPECT_TRUE(after.end[axis] > grid.size()[axis] || !is_free(grid, {}, after.first, after.end));
      }
      for (int z = block->first[2]; z < block->end[2]; ++z)
        for (int y = block->first[1]; y < block->end[1]; ++y)
          for (int x = block->first[0]; x < block->end[0]; ++x)
            given[static_cast<std::size_t>((z * ny + y) * nx + x)] = 1;
    }
  }
}

constexpr CellBox eyes{{-1, -1, -1}, {1, 1, 1}};
constexpr CellBox box{{19, -3, -3}, {21, 3, 3}};

// A closed block, or one without its front, that is turned to the eyes, or its back.
enum class Open { nowhere, in_front, behind };
CellSurface block(const CellBox& b, Open open = Open::nowhere, float moved = 0.0F) {
  std::vector<glm::dvec3> positions;
  for (std::size_t k = 0; k < 8; ++k) positions.push_back(corner_of(b, k));
  std::vector<Triangle> triangles;
  const auto side = [&](VertexId a, VertexId c, VertexId d, VertexId e) {
    triangles.insert(triangles.end(), {{a, c, d}, {a, d, e}});
  };
  if (open != Open::in_front) side(0, 4, 6, 2);
  if (open != Open::behind) side(1, 3, 7, 5);
  side(0, 1, 5, 4);
  side(2, 6, 7, 3);
  side(0, 2, 3, 1);
  side(4, 5, 7, 6);
  return {positions, triangles, std::vector<float>(triangles.size(), moved)};
}

bool boxes_hide(const CellSurface& surface, const CellBox& cell = eyes, double near_reach = 0.0) {
  const InnerBoxes boxes(surface);
  InnerBoxTest test(surface, boxes);
  test.set_cell(cell, near_reach);
  bool hidden = false;
  for (std::uint32_t part = 0; part < boxes.part_count(); ++part) hidden = hidden || test.hides(box, part);
  EXPECT_EQ(test.hides_again(box), hidden);
  return hidden;
}

// As far outwards as the surface, or what it may stand for, allows.
TEST(InnerBoxes, FillABlock) {
  const CellBox b{{9, -2.5, -2.25}, {13, 2.5, 2.25}};
  for (const float moved : {0.0F, 0.125F}) {
    const CellSurface surface = block(b, Open::nowhere, moved);
    const InnerBoxes boxes(surface);
    ASSERT_EQ(boxes.part_count(), 1U);
    ASSERT_GE(boxes.boxes().size(), 1U);
    const CellBox inner = boxes.boxes()[0], expected = grown(b, -static_cast<double>(moved));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GT(inner.min[axis], expected.min[axis]);
      EXPECT_NEAR(inner.min[axis], expected.min[axis], 1e-6);
      EXPECT_LT(inner.max[axis], expected.max[axis]);
      EXPECT_NEAR(inner.max[axis], expected.max[axis], 1e-6);
    }
  }
}

// The highest segment runs from (-1, 1) to (19, 3): where it comes to the block, at x = 9, it is 2 above the axis.
TEST(InnerBoxes, ABlockHidesIffAllSegmentsMeetIt) {
  EXPECT_TRUE(boxes_hide(block({{9, -2.001, -2.001}, {13, 2.001, 2.001}})));
  EXPECT_FALSE(boxes_hide(block({{9, -1.999, -2.001}, {13, 1.999, 2.001}})));
  EXPECT_FALSE(boxes_hide(block({{9, 0, -2.5}, {13, 2.5, 2.5}})));
}

// As they are drawn, they would; the input may be smaller.
TEST(InnerBoxes, WhatMayHaveMovedHidesLess) {
  const CellBox b{{9, -2.2, -2.2}, {13, 2.2, 2.2}};
  EXPECT_TRUE(boxes_hide(block(b)));
  EXPECT_TRUE(boxes_hide(block(b, Open::nowhere, 0.125F)));
  EXPECT_FALSE(boxes_hide(block(b, Open::nowhere, 0.25F)));
}

// One sees into it, or only its outside.
TEST(InnerBoxes, ABlockMayBeOpenWhereNoOneSeesIt) {
  const CellBox b{{9, -3, -3}, {13, 3, 3}};
  EXPECT_FALSE(boxes_hide(block(b, Open::in_front)));
  EXPECT_TRUE(boxes_hide(block(b, Open::behind)));
}

TEST(InnerBoxes, WhatIsAtTheCellHidesNothing) {
  const CellBox b{{9, -3, -3}, {13, 3, 3}};
  EXPECT_FALSE(boxes_hide(block(b), {{8, -1, -1}, {9.5, 1, 1}}));    // in its front
  EXPECT_FALSE(boxes_hide(block(b), {{10, -1, -1}, {11, 1, 1}}));    // inside
  EXPECT_TRUE(boxes_hide(block(b), {{7, -1, -1}, {8, 1, 1}}, 0.9));  // clipped no farther than 8.9
  EXPECT_FALSE(boxes_hide(block(b), {{7, -1, -1}, {8, 1, 1}}, 1.1));
}

TEST(InnerBoxes, HullTestsAskThemFirst) {
  const CellSurface surface = block({{9, -3, -3}, {13, 3, 3}});
  const InnerBoxes boxes(surface);
  HullTest test(surface, &boxes);
  test.set_cell(eyes, 0.0);
  EXPECT_TRUE(test.hides(box));
  EXPECT_TRUE(test.hides({{12, -1, -1}, {14, 1, 1}}));  // half in it: behind its front
  EXPECT_EQ(test.counts().boxed, 2U);
  EXPECT_EQ(test.counts().floods, 0U);
  // Its front is no wider than the box, at its feet.
  EXPECT_TRUE(test.hides({{13.5, 2.8, 2.8}, {13.6, 3, 3}}));
  EXPECT_FALSE(test.hides({{13.5, 2.8, 2.8}, {13.6, 5, 3}}));
}

// Of boxes around points of the mesh, that its inner boxes hide from cells beside it: no segment between both passes.
void expect_conservative(const TriangleMesh& mesh, double max_motion, int min_hidden) {
  const Hierarchy hierarchy = build_hierarchy(mesh);
  const RefineObject objects[] = {{.hierarchy = &hierarchy}};
  const CellSurface surface(objects, max_motion);
  const InnerBoxes boxes(surface);
  InnerBoxTest test(surface, boxes);
  const test::RayScene input(mesh.positions, mesh.triangles);
  test::RandomShapes random(5);
  const auto around = [](const glm::dvec3& p, double half) { return CellBox{p - half, p + half}; };
  const auto any = [&](const CellBox& in) {
    return glm::mix(in.min, in.max, glm::dvec3(random.in(0, 1), random.in(0, 1), random.in(0, 1)));
  };
  int hidden = 0, passed = 0;
  for (int n = 0; n < 60'000; ++n) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(random.below(static_cast<int>(mesh.triangles.size())))];
    const glm::dvec3 p = glm::dvec3(mesh.positions[t.x]) + random.point(0.02), direction = random.unit();
    const CellBox cell = around(p + random.in(0.1, 1.5) * direction, random.in(0.0, 0.05));
    const CellBox what = around(p - random.in(0.0, 1.5) * direction, random.in(0.0, 0.05));
    test.set_cell(cell, 0.0);
    bool is_hidden = false;
    for (std::uint32_t part = 0; part < boxes.part_count() && !is_hidden; ++part) is_hidden = test.hides(what, part);
    if (!is_hidden) continue;
    ++hidden;
    for (int k = 0; k < 30; ++k) {
      const glm::dvec3 from = any(cell), to = any(what);
      passed += input.first_hit(from, to - from) < 1.0 ? 0 : 1;
    }
  }
  EXPECT_EQ(passed, 0);
  EXPECT_GT(hidden, min_hidden);
}

TEST(InnerBoxes, Ball) {
  expect_conservative(test::noisy_sphere(4, 6), 0.0, 5000);
  expect_conservative(test::noisy_sphere(4, 6), 0.05, 5000);
}
TEST(InnerBoxes, BlockWithTunnels) { expect_conservative(test::block(true), 0.02, 10); }
TEST(InnerBoxes, BlockWithGrooves) { expect_conservative(test::block(false), 0.05, 50); }
TEST(InnerBoxes, SheetsHaveNone) {
  const CellSurface surface = [] {
    const TriangleMesh mesh = test::sheet_with_windows();
    std::vector<glm::dvec3> positions(mesh.positions.begin(), mesh.positions.end());
    return CellSurface(positions, mesh.triangles, {});
  }();
  EXPECT_TRUE(InnerBoxes(surface).boxes().empty());
}

}  // namespace
}  // namespace occlod
