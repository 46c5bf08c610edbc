// Cells, how they are joined, and what is done about slivers and folds.
#include "hlod/build/cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "hlod/build/finish_level.h"
#include "hlod/build/group_triangles.h"
#include "support/meshes.h"

namespace occlod::hlod {
namespace {

std::vector<std::uint64_t> random_codes(std::size_t count) {
  std::mt19937_64 random(1);
  std::vector<std::uint64_t> codes(count);
  for (std::uint64_t& code : codes) code = random() >> 1U;
  return codes;
}

TEST(Cells, AreFullRunsOfTheCurve) {
  const std::vector<std::uint64_t> codes = random_codes(5000);
  const Cells cells = make_cells(codes, 100, {}, 1);
  ASSERT_EQ(cells.order.size(), codes.size());
  std::set<std::uint32_t> items(cells.order.begin(), cells.order.end());
  EXPECT_EQ(items.size(), codes.size());
  EXPECT_EQ(cells.first_item.front(), 0U);
  EXPECT_EQ(cells.first_item.back(), codes.size());
  for (std::uint32_t leaf = 0; leaf < cells.leaf_count(); ++leaf) {
    EXPECT_GE(cells.item_count(leaf), 1U);
    EXPECT_LE(cells.item_count(leaf), 100U);
  }
  for (const LeafRange& inner : cells.inner)
    EXPECT_GT(cells.first_item[inner.end] - cells.first_item[inner.first], 100U) << "was split, but fits";
  const Cells again = make_cells(codes, 100, {}, 3);
  EXPECT_TRUE(again.order == cells.order);
  EXPECT_EQ(again.first_item, cells.first_item);
}

TEST(Cells, AreSplitBelowTheSortedBits) {
  // Two items that only the last of 63 bits tells apart.
  const std::vector<std::uint64_t> codes = {5, 4, 5, 4};
  const Cells cells = make_cells(codes, 2, {}, 1);
  ASSERT_EQ(cells.leaf_count(), 2U);
  EXPECT_TRUE((cells.order == UninitializedVector<std::uint32_t>{1, 3, 0, 2}));
}

TEST(Cells, WhatLiesInOnePlaceIsCutById) {
  const std::vector<std::uint64_t> codes(10, 77);
  const Cells cells = make_cells(codes, 4, {}, 1);
  EXPECT_EQ(cells.first_item, (std::vector<std::uint32_t>{0, 4, 8, 10}));
  // Units 0 0 0 1 1 1 2 2 2 2 are not torn apart, but for those that are too large themselves.
  const std::vector<std::uint32_t> unit_of = {0, 0, 0, 1, 1, 1, 2, 2, 2, 2};
  EXPECT_EQ(make_cells(codes, 4, unit_of, 1).first_item, (std::vector<std::uint32_t>{0, 3, 6, 10}));
  const std::vector<std::uint32_t> one_unit(10, 0);
  EXPECT_EQ(make_cells(codes, 4, one_unit, 1).first_item, (std::vector<std::uint32_t>{0, 4, 8, 10}));
}

// Items in cells of so many each, all in one inner cell.
Cells row_of_cells(const std::vector<std::uint32_t>& sizes) {
  Cells cells;
  std::uint32_t begin = 0;
  for (const std::uint32_t size : sizes) {
    cells.first_item.push_back(begin);
    begin += size;
  }
  cells.first_item.push_back(begin);
  cells.order.resize(begin);
  std::iota(cells.order.begin(), cells.order.end(), 0U);
  cells.inner.push_back({0, static_cast<std::uint32_t>(sizes.size())});
  return cells;
}

TEST(JoinCells, JoinsThoseThatShareMostWhileTheyFit) {
  // Five triangles, a cell each: 0 and 2 share an edge, 1 and 3 a vertex, 4 nothing.
  const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 4, 5}, {1, 0, 6}, {5, 7, 8}, {9, 10, 11}};
  const Cells cells = row_of_cells({1, 1, 1, 1, 1});
  EXPECT_EQ(join_cells(cells, triangles, 12, 2, 1).group_of, (std::vector<std::uint32_t>{0, 1, 0, 1, 2}));
  EXPECT_EQ(join_cells(cells, triangles, 12, 1, 1).count, 5U) << "nothing fits";
  const std::vector<Triangle> strip = {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}};
  const CellGroups groups = join_cells(row_of_cells({1, 1, 1, 1}), strip, 6, 2, 1);
  EXPECT_EQ(groups.group_of, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  EXPECT_EQ(separate_cells(cells).count, 5U);
}

TEST(JoinCells, TheResultDoesNotDependOnTheThreads) {
  const TriangleMesh mesh = test::noisy_sphere(6, 2);
  const OctreeGrid grid(bounding_box(mesh.positions));
  std::vector<std::uint64_t> codes;
  for (const Triangle& t : mesh.triangles) codes.push_back(grid.code(glm::dvec3(mesh.positions[t.x]), 1));
  const Cells cells = make_cells(codes, 300, {}, 1);
  const CellGroups one = join_cells(cells, mesh.triangles, mesh.vertex_count(), 300, 1);
  const CellGroups many = join_cells(cells, mesh.triangles, mesh.vertex_count(), 300, 5);
  EXPECT_EQ(one.group_of, many.group_of);
  EXPECT_LT(one.count, cells.leaf_count());
  std::vector<std::uint32_t> size(one.count, 0);
  for (std::uint32_t cell = 0; cell < cells.leaf_count(); ++cell) size[one.group_of[cell]] += cells.item_count(cell);
  EXPECT_LE(*std::max_element(size.begin(), size.end()), 300U);
}

TEST(MoveSlivers, ToTheGroupThatSharesMostVertices) {
  // One node with a strip of 64 triangles: two of them in group 1, between 30 in group 0 and 32 in group 2;
  // patches of less than 3 are slivers. Both neighbours share as many vertices; the larger patch
  // wins. Group 1 is empty then, and groups are numbered anew.
  LevelDraft level;
  for (VertexId v = 0; v < 64; ++v) level.triangles.push_back({v, v + 1, v + 2});
  level.nodes.resize(1);
  level.nodes[0].triangle_count = 64;
  TriangleGroups groups{UninitializedVector<std::uint32_t>(64, 0), 3};
  std::fill(groups.group_of.begin() + 30, groups.group_of.begin() + 32, 1U);
  std::fill(groups.group_of.begin() + 32, groups.group_of.end(), 2U);
  move_slivers(level, hlod_reduction(96), groups, 1);
  EXPECT_EQ(groups.count, 2U);
  EXPECT_EQ(std::count(groups.group_of.begin(), groups.group_of.end(), 0U), 30);
  EXPECT_EQ(std::count(groups.group_of.begin(), groups.group_of.end(), 1U), 34);
}

TEST(CancelFolded, PairsThatMergingMadeGoAndTheRestStays) {
  // 0 1 2 and its reverse were two faces, and two of 3 4 5 against one; 7 8 9 has been two-sided from the start.
  std::vector<Triangle> triangles = {{0, 1, 2}, {3, 4, 5}, {1, 0, 2}, {4, 5, 3}, {5, 4, 3}, {7, 8, 9}, {7, 9, 8}};
  const std::vector<Triangle> before = {{0, 1, 2},  {3, 4, 5},  {1, 0, 11}, {4, 5, 12},
                                        {5, 4, 13}, {7, 8, 14}, {7, 14, 8}};
  std::vector<Triangle> none;
  cancel_folded(triangles, none, before);
  EXPECT_EQ(triangles, (std::vector<Triangle>{{4, 5, 3}, {7, 8, 9}, {7, 9, 8}}));
  std::vector<Triangle> same = {{0, 1, 2}, {1, 2, 0}};
  cancel_folded(same, none, std::vector<Triangle>{{0, 1, 2}, {1, 2, 3}});
  EXPECT_EQ(same.size(), 2U) << "the same winding twice is a boundary twice";
}

}  // namespace
}  // namespace occlod::hlod
