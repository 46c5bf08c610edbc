#include "splits/star_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "splits/collapse_rules.h"
#include "support/meshes.h"

namespace occlod {
namespace {

constexpr CollapseId made = 7;  // any number

// Each star says the same of every face: a face is there from all of its corners or from none.
void expect_consistent(const StarMesh& mesh) {
  const auto has = [&](VertexId v, const StarFace& face) {
    for (const StarFace f : mesh.star(v))
      if (f == face) return true;
    return false;
  };
  for (VertexId v = 0; v < mesh.vertex_count(); ++v)
    for (const StarFace f : mesh.star(v)) {
      EXPECT_TRUE(has(f.next, {f.last, v, f.made_by})) << v << " " << f.next << " " << f.last;
      EXPECT_TRUE(has(f.last, {v, f.next, f.made_by})) << v << " " << f.next << " " << f.last;
    }
}

std::vector<LevelFace> ended_by_collapse(StarMesh& mesh, StarArena& arena, VertexId v, VertexId u,
                                         bool may_fold = true) {
  std::vector<LevelFace> ended;
  const std::size_t before = mesh.faces().size();
  const std::size_t gone = mesh.collapse(v, u, made, may_fold, arena, ended);
  EXPECT_EQ(mesh.faces().size(), before - gone);
  expect_consistent(mesh);
  return ended;
}

TEST(StarMesh, CollapseMovesTheStarToTheOtherEnd) {
  // Vertex 0 with six faces around it: merging it into a neighbour changes all six; the two that hold both ends are
  // gone, four move.
  const TriangleMesh fan = test::fan(6);
  StarArena arena;
  StarMesh mesh(fan.triangles, fan.vertex_count());
  EXPECT_EQ(ended_by_collapse(mesh, arena, 0, 1).size(), 6U);
  EXPECT_EQ(mesh.faces().size(), 4U);
  EXPECT_TRUE(mesh.star(0).empty());
  EXPECT_EQ(mesh.star(1).size(), 4U);
  for (const LevelFace& face : mesh.faces()) {
    EXPECT_TRUE(contains(face.corners, 1));
    EXPECT_FALSE(contains(face.corners, 0));
    EXPECT_EQ(face.made_by, made);
  }
}

TEST(StarMesh, FacesOfAFanEndInRingOrder) {
  // Whatever order the faces come in, and after collapses beside the vertex: face j is (v, r_j, r_j+1), the last
  // closes.
  TriangleMesh sphere = test::noisy_sphere(3, 2);
  std::shuffle(sphere.triangles.begin(), sphere.triangles.end(), std::mt19937(1));
  StarMesh mesh(sphere.triangles, sphere.vertex_count());
  StarArena arena;
  VertexRing ring;
  int collapses = 0;
  for (VertexId v = 0; v < sphere.vertex_count(); ++v) {
    ring.gather(mesh, v);
    ASSERT_TRUE(mesh.star(v).is_ring());
    if (!keeps_topology(mesh, ring, 0)) continue;
    const std::size_t size = mesh.star(v).size();
    const auto ended = ended_by_collapse(mesh, arena, v, ring.neighbours()[0], false);
    ASSERT_EQ(ended.size(), size);
    for (std::size_t j = 0; j < size; ++j) {
      EXPECT_EQ(ended[j].corners.x, v);
      EXPECT_EQ(ended[j].corners.z, ended[(j + 1) % size].corners.y);
    }
    ++collapses;
  }
  EXPECT_GT(collapses, 100);
}

TEST(StarMesh, WhatAFoldMakesOfAStarIsARingAgain) {
  // Two tetrahedra that share vertex 0: its star is two fans until one of them has been folded flat.
  TriangleMesh mesh = test::tetrahedron();
  mesh.positions.resize(7);
  for (Triangle t : test::tetrahedron().triangles) {
    for (int k = 0; k < 3; ++k) t[k] = t[k] == 0 ? 0 : t[k] + 3;
    mesh.triangles.push_back(t);
  }
  StarMesh stars(mesh.triangles, mesh.vertex_count());
  StarArena arena;
  EXPECT_FALSE(stars.star(0).is_ring());
  ended_by_collapse(stars, arena, 4, 5);
  EXPECT_EQ(stars.faces().size(), 4U);
  EXPECT_TRUE(stars.star(0).is_ring());
}

TEST(StarMesh, TetrahedronFoldsFlatAndIsGone) {
  // Two of the three faces at vertex 0 hold vertex 1 as well; the third lands on the opposite face, turned over.
  const TriangleMesh tetrahedron = test::tetrahedron();
  StarArena arena;
  StarMesh mesh(tetrahedron.triangles, 4);
  EXPECT_EQ(ended_by_collapse(mesh, arena, 0, 1).size(), 4U);
  EXPECT_TRUE(mesh.faces().empty());
  for (VertexId v = 0; v < 4; ++v) EXPECT_TRUE(mesh.star(v).empty());
}

TEST(StarMesh, DoubleSidedFacesMoveTogether) {
  // Both sides of a sheet are there on purpose: they move as a pair, they do not cancel.
  TriangleMesh sheet;
  sheet.positions.resize(5);
  sheet.triangles = {{0, 1, 2}, {0, 2, 1}, {0, 2, 3}, {0, 3, 2}, {0, 3, 4}, {0, 4, 3}};
  StarArena arena;
  StarMesh mesh(sheet.triangles, 5);
  (void)ended_by_collapse(mesh, arena, 0, 1);
  EXPECT_EQ(mesh.faces().size(), 4U);
}

TEST(StarMesh, StarsGrowBeyondTheirFirstPlace) {
  // Vertex 1 takes over vertex 0's large star one collapse after the other.
  const TriangleMesh sphere = test::octahedron_sphere(3);
  StarMesh mesh(sphere.triangles, sphere.vertex_count());
  StarArena arena;
  std::vector<VertexId> around;
  for (int n = 0; n < 40; ++n) {
    mesh.neighbours(0, around);
    (void)ended_by_collapse(mesh, arena, around[0], 0);
  }
  const std::vector<LevelFace> faces = mesh.faces();
  const auto holding =
      std::count_if(faces.begin(), faces.end(), [](const LevelFace& face) { return contains(face.corners, 0); });
  EXPECT_EQ(mesh.star(0).size(), static_cast<std::size_t>(holding));
  EXPECT_GT(mesh.star(0).size(), 8U);
}

TEST(StarMesh, ARingStaysOneAtEverySize) {
  // Neighbours are merged into vertex 0 until it has more than 16, twice the first place, and then into each other
  // until it has 4. The link condition keeps every star a ring.
  constexpr VertexId hub = 0;
  const TriangleMesh sphere = test::noisy_sphere(3, 2);
  StarArena arena;
  StarMesh mesh(sphere.triangles, sphere.vertex_count());
  VertexRing ring;
  const auto merge_a_neighbour = [&](bool into_hub) {
    const auto neighbours = mesh.star(hub).ring();
    for (const VertexId v : std::vector<VertexId>(neighbours.begin(), neighbours.end())) {
      ring.gather(mesh, v);
      for (std::size_t i = 0; i < ring.neighbours().size(); ++i) {
        const VertexId u = ring.neighbours()[i];
        if ((u == hub) != into_hub || !keeps_topology(mesh, ring, i)) continue;
        ended_by_collapse(mesh, arena, v, u, false);
        return true;
      }
    }
    return false;
  };
  while (mesh.star(hub).size() <= 17) ASSERT_TRUE(merge_a_neighbour(true));
  while (mesh.star(hub).size() > 4) ASSERT_TRUE(merge_a_neighbour(false));
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.star(v).empty()) continue;
    ASSERT_TRUE(mesh.star(v).is_ring());
    ring.gather(mesh, v);
    EXPECT_EQ(ring.neighbours().size(), mesh.star(v).size());
  }
}

TEST(StarMesh, ThreadsDoNotChangeTheStars) {
  const TriangleMesh sphere = test::noisy_sphere(6, 2);  // enough vertices for several threads
  const StarMesh one(sphere.triangles, sphere.vertex_count(), 1), many(sphere.triangles, sphere.vertex_count(), 3);
  for (VertexId v = 0; v < sphere.vertex_count(); ++v) {
    ASSERT_EQ(one.star(v).size(), many.star(v).size());
    for (std::size_t i = 0; i < one.star(v).size(); ++i) ASSERT_EQ(one.star(v)[i], many.star(v)[i]);
  }
}

TEST(StarMesh, EdgeDegreeCountsFaces) {
  const TriangleMesh book = test::book(5);
  const StarMesh mesh(book.triangles, book.vertex_count());
  EXPECT_EQ(mesh.edge_degree(0, 1), 5);
  EXPECT_EQ(mesh.edge_degree(1, 0), 5);
  EXPECT_EQ(mesh.edge_degree(0, 2), 1);
  EXPECT_EQ(mesh.edge_degree(2, 3), 0);
}

}  // namespace
}  // namespace occlod
