#include "hierarchy/star_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/meshes.h"

namespace occlod {
namespace {

std::vector<FaceId> ended_by_collapse(StarMesh& mesh, VertexId v, VertexId u) {
  std::vector<FaceId> ended;
  mesh.collapse(v, u, ended);
  std::sort(ended.begin(), ended.end());
  return ended;
}

TEST(StarMesh, CollapseEndsTheStarAndMakesItAgainAtTheOtherEnd) {
  // Vertex 0 with six faces around it: merging it into a neighbour ends all six and makes the four that do not hold
  // both.
  const TriangleMesh fan = test::fan(6);
  StarMesh mesh(fan.triangles, fan.vertex_count());
  const auto ended = ended_by_collapse(mesh, 0, 1);
  EXPECT_EQ(ended.size(), 6U);
  EXPECT_EQ(mesh.face_count(), 10U);
  EXPECT_EQ(mesh.live_face_count(), 4U);
  EXPECT_TRUE(mesh.star(0).empty());
  EXPECT_EQ(mesh.star(1).size(), 4U);
  for (const FaceId f : mesh.live_faces()) {
    EXPECT_GE(f, 6U);
    EXPECT_EQ(mesh.face(f).x, 1U);
    EXPECT_FALSE(contains(mesh.face(f), 0));
  }
}

TEST(StarMesh, TetrahedronFoldsFlatAndIsGone) {
  // Two of the three faces at vertex 0 hold vertex 1 as well; the third lands on the opposite face, turned over.
  const TriangleMesh tetrahedron = test::tetrahedron();
  StarMesh mesh(tetrahedron.triangles, 4);
  EXPECT_EQ(ended_by_collapse(mesh, 0, 1), (std::vector<FaceId>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.live_face_count(), 0U);
  EXPECT_EQ(mesh.face_count(), 4U);
  for (VertexId v = 0; v < 4; ++v) EXPECT_TRUE(mesh.star(v).empty());
}

TEST(StarMesh, DoubleSidedFacesMoveTogether) {
  // Both sides of a sheet are there on purpose: they move as a pair, they do not cancel.
  TriangleMesh sheet;
  sheet.positions.resize(5);
  sheet.triangles = {{0, 1, 2}, {0, 2, 1}, {0, 2, 3}, {0, 3, 2}, {0, 3, 4}, {0, 4, 3}};
  StarMesh mesh(sheet.triangles, 5);
  (void)ended_by_collapse(mesh, 0, 1);
  EXPECT_EQ(mesh.live_face_count(), 4U);
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
