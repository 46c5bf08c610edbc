#include "splits/simplify_group.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "splits/positions.h"
#include "splits/triangle_keys.h"
#include "support/meshes.h"

namespace occlod {
namespace {

using Locked = std::vector<std::uint8_t>;

GroupTarget target_for(const TriangleMesh& mesh, std::size_t min_triangles) {
  GroupTarget target;
  target.scale = power_of_two_scale(mesh.positions);
  target.min_triangles = min_triangles;
  return target;
}

ChainSum boundary_of(const std::vector<Triangle>& triangles, const std::vector<VertexId>& image) {
  ChainSum sum;
  for (const Triangle& t : triangles)
    for_each_edge(t, [&](VertexId from, VertexId to) { sum.add(image[from], image[to]); });
  return sum;
}

std::vector<VertexId> identity(std::size_t count) {
  std::vector<VertexId> ids(count);
  for (VertexId v = 0; v < count; ++v) ids[v] = v;
  return ids;
}

Locked boundary_of_grid(int n) {
  Locked locked;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) locked.push_back(x == 0 || y == 0 || x == n || y == n ? 1 : 0);
  return locked;
}

TEST(SimplifyGroup, LockedVerticesStayAndOthersGo) {
  // A flat square whose 4 * 10 border vertices are locked: all inside goes, and the fewest triangles
  // that a disc with 40 vertices on its border can have are 38.
  const TriangleMesh mesh = test::grid(10, 10);
  const Locked locked = boundary_of_grid(10);
  const SimplifiedGroup group = simplify_group(mesh, locked, target_for(mesh, 0));
  for (VertexId v = 0; v < mesh.vertex_count(); ++v)
    if (locked[v] != 0)
      EXPECT_EQ(group.merged_into[v], v);
    else
      EXPECT_NE(locked[group.merged_into[v]], 0) << "vertex " << v << " is left";
  EXPECT_EQ(group.triangles.size(), 38U);
}

TEST(SimplifyGroup, WhatIsAllLockedStaysAsItIs) {
  const TriangleMesh mesh = test::noisy_sphere(2, 1);
  const SimplifiedGroup group = simplify_group(mesh, Locked(mesh.vertex_count(), 1), target_for(mesh, 0));
  EXPECT_EQ(group.triangles.size(), mesh.triangle_count());
  EXPECT_EQ(group.merged_into, identity(mesh.vertex_count()));
  EXPECT_EQ(group.cost, 0.0F);
}

TEST(SimplifyGroup, BoundaryIsTheImageOfTheInputs) {
  for (const TriangleMesh& mesh : {test::noisy_sphere(4, 3), test::grid(20, 20), test::moebius(40), test::book(7)}) {
    Locked locked(mesh.vertex_count(), 0);
    for (VertexId v = 0; v < locked.size(); v += 7) locked[v] = 1;
    for (const std::size_t least : {std::size_t{0}, mesh.triangle_count() / 4}) {
      const SimplifiedGroup group = simplify_group(mesh, locked, target_for(mesh, least));
      EXPECT_TRUE(boundary_of(group.triangles, identity(mesh.vertex_count())) ==
                  boundary_of(mesh.triangles, group.merged_into));
      for (const VertexId v : group.merged_into) EXPECT_EQ(group.merged_into[v], v) << "not the last target";
    }
  }
}

TEST(SimplifyGroup, EndsAtTheCostAndAtTheTriangles) {
  const TriangleMesh mesh = test::noisy_sphere(4, 3);
  GroupTarget target = target_for(mesh, mesh.triangle_count() / 4);
  const SimplifiedGroup quarter = simplify_group(mesh, {}, target);
  EXPECT_LE(quarter.triangles.size(), mesh.triangle_count() / 4);
  EXPECT_GE(quarter.triangles.size(), mesh.triangle_count() / 4 - 1);  // a collapse inside a surface ends two
  target.max_cost = quarter.cost / 4.0F;
  const SimplifiedGroup cheap = simplify_group(mesh, {}, target);
  EXPECT_GT(cheap.triangles.size(), quarter.triangles.size());
  EXPECT_LE(cheap.cost, target.max_cost);
  EXPECT_LE(cheap.error, quarter.error);
}

TEST(SimplifyGroup, CollapsesLeadToTheResultInAnyPartOfTheirOrder) {
  for (const TriangleMesh& mesh :
       {test::noisy_sphere(4, 3), test::grid(20, 20), test::moebius(40), test::book(7), test::many_tetrahedra(20)}) {
    GroupTarget target = target_for(mesh, mesh.triangle_count() / 10);
    EXPECT_TRUE(simplify_group(mesh, {}, target).collapses.empty()) << "not wanted";
    EXPECT_TRUE(simplify_group(mesh, {}, target).bounds.empty()) << "not wanted";
    target.lists_bounds = true;
    const SimplifiedGroup bounded = simplify_group(mesh, {}, target);
    EXPECT_EQ(bounded.bounds.size(), bounded.triangles.size());
    target.lists_bounds = target.keeps_bounds = false;
    const SimplifiedGroup bare = simplify_group(mesh, {}, target);
    EXPECT_EQ(bare.triangles, bounded.triangles);
    EXPECT_EQ(bare.cost, bounded.cost);
    target.keeps_bounds = true;
    target.keeps_collapses = true;
    const SimplifiedGroup group = simplify_group(mesh, {}, target);
    // From fine to coarse: what a vertex is merged into is still there, and errors ascend to the largest.
    std::vector<VertexId> image = identity(mesh.vertex_count());
    float error = 0.0F;
    for (std::size_t i = group.collapses.size(); i-- > 0;) {
      const GroupCollapse& c = group.collapses[i];
      EXPECT_EQ(image[c.v], c.v);
      EXPECT_EQ(image[c.u], c.u);
      EXPECT_GE(c.error, error);
      error = c.error;
      for (VertexId& v : image) v = v == c.v ? c.u : v;
    }
    EXPECT_EQ(image, group.merged_into);
    EXPECT_EQ(error, group.error);
  }
}

TEST(SimplifyGroup, CostsOfGroupsCompareWhateverTheirSize) {
  // The same bump in a mesh of its own and beside a triangle far away, by the scale of the larger mesh.
  const TriangleMesh small = test::noisy_sphere(3, 3);
  TriangleMesh large = small;
  test::append(large, test::single_triangle(), {100.0F, 0.0F, 0.0F});
  const GroupTarget target = target_for(large, 20);
  Locked locked(large.vertex_count(), 0);
  std::fill(locked.begin() + static_cast<std::ptrdiff_t>(small.vertex_count()), locked.end(), 1);
  const SimplifiedGroup a = simplify_group(small, {}, {target.scale, 1.0, target.max_cost, 20});
  const SimplifiedGroup b = simplify_group(large, locked, {target.scale, 1.0, target.max_cost, 21});
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.triangles.size() + 1, b.triangles.size());
}

}  // namespace
}  // namespace occlod
