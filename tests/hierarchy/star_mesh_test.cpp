#include "hierarchy/star_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/meshes.h"

namespace occlod {
namespace {

std::vector<FaceId> ended_by_collapse(StarMesh& mesh, StarArena& arena, VertexId v, VertexId u) {
  std::vector<FaceId> ended;
  (void)mesh.collapse(v, u, true, arena, [&](FaceId f) { ended.push_back(f); });
  std::sort(ended.begin(), ended.end());
  return ended;
}

TEST(StarMesh, CollapseMovesTheStarToTheOtherEnd) {
  // Vertex 0 with six faces around it: merging it into a neighbour changes all six; the two that hold both ends are
  // gone, four move.
  const TriangleMesh fan = test::fan(6);
  StarArena arena;
  StarMesh mesh(fan.triangles, fan.vertex_count());
  const auto ended = ended_by_collapse(mesh, arena, 0, 1);
  EXPECT_EQ(ended, (std::vector<FaceId>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(mesh.live_faces().size(), 4U);
  EXPECT_TRUE(mesh.star(0).empty());
  EXPECT_EQ(mesh.star(1).size(), 4U);
  for (const FaceId f : mesh.live_faces()) {
    EXPECT_TRUE(contains(mesh.face(f), 1));
    EXPECT_FALSE(contains(mesh.face(f), 0));
  }
}

TEST(StarMesh, EndIsToldWhileTheOldCornersAreThere) {
  const TriangleMesh fan = test::fan(6);
  StarMesh mesh(fan.triangles, fan.vertex_count());
  StarArena arena;
  const std::size_t gone =
      mesh.collapse(0, 1, false, arena, [&](FaceId f) { EXPECT_EQ(mesh.face(f), fan.triangles[f]); });
  EXPECT_EQ(gone, 2U);
}

TEST(StarMesh, TetrahedronFoldsFlatAndIsGone) {
  // Two of the three faces at vertex 0 hold vertex 1 as well; the third lands on the opposite face, turned over.
  const TriangleMesh tetrahedron = test::tetrahedron();
  StarArena arena;
  StarMesh mesh(tetrahedron.triangles, 4);
  EXPECT_EQ(ended_by_collapse(mesh, arena, 0, 1), (std::vector<FaceId>{0, 1, 2, 3}));
  EXPECT_TRUE(mesh.live_faces().empty());
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
  EXPECT_EQ(mesh.live_faces().size(), 4U);
}

TEST(StarMesh, StarsGrowBeyondTheirFirstPlace) {
  // Vertex 1 takes over vertex 0's large star one collapse after the other.
  const TriangleMesh sphere = test::octahedron_sphere(3);
  StarMesh mesh(sphere.triangles, sphere.vertex_count());
  StarArena arena;
  std::vector<VertexId> around;
  for (int n = 0; n < 40; ++n) {
    mesh.neighbours(0, around);
    (void)mesh.collapse(around[0], 0, true, arena, [](FaceId) {});
  }
  std::vector<FaceId> holding;
  for (const FaceId f : mesh.live_faces())
    if (contains(mesh.face(f), 0)) holding.push_back(f);
  std::vector<FaceId> star(mesh.star(0).begin(), mesh.star(0).end());
  std::sort(star.begin(), star.end());
  EXPECT_EQ(star, holding);
  EXPECT_GT(star.size(), 8U);
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
