#include "splits/collapse_rules.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/meshes.h"

namespace occlod {
namespace {

bool legal(const TriangleMesh& mesh, VertexId v, VertexId u) {
  const StarMesh stars(mesh.triangles, mesh.vertex_count());
  VertexRing ring;
  ring.gather(stars, v);
  const auto at = std::find(ring.neighbours().begin(), ring.neighbours().end(), u);
  EXPECT_NE(at, ring.neighbours().end());
  return keeps_topology(stars, ring, static_cast<std::size_t>(at - ring.neighbours().begin()));
}

TEST(KeepsTopology, InsideAClosedSurface) {
  const TriangleMesh sphere = test::octahedron_sphere(2);
  EXPECT_TRUE(legal(sphere, sphere.triangles[0].x, sphere.triangles[0].y));
}

TEST(KeepsTopology, NotWhenATetrahedronWouldFoldFlat) {
  EXPECT_FALSE(legal(test::tetrahedron(), 0, 1));  // the edge opposite to 0-1 is in both links
}

TEST(KeepsTopology, NotAroundAHandleOfThreeEdges) {
  // The cross-section of this torus is a triangle of edges without a face: merging two of its corners would pinch the
  // tube.
  const TriangleMesh torus = test::torus(12, 3);
  const StarMesh mesh(torus.triangles, torus.vertex_count());
  int empty_triangles = 0;
  for (VertexId a = 0; a < torus.vertex_count(); ++a) {
    std::vector<VertexId> around_a, around_b;
    mesh.neighbours(a, around_a);
    for (const VertexId b : around_a) {
      mesh.neighbours(b, around_b);
      std::vector<VertexId> common;
      std::set_intersection(around_a.begin(), around_a.end(), around_b.begin(), around_b.end(),
                            std::back_inserter(common));
      if (common.size() <= 2) continue;  // the two faces of the edge
      ++empty_triangles;
      EXPECT_FALSE(legal(torus, a, b));
    }
  }
  EXPECT_EQ(empty_triangles, 12 * 6);  // twelve cross-sections with three edges, seen from both ends
}

TEST(KeepsTopology, BoundaryVerticesMoveAlongTheBoundaryOnly) {
  const TriangleMesh grid = test::grid(4, 4);
  const auto at = [&](float x, float y) {
    const auto found = std::find(grid.positions.begin(), grid.positions.end(), glm::vec3(x, y, 0));
    return static_cast<VertexId>(found - grid.positions.begin());
  };
  const VertexId side = at(0.5F, 0.0F), next_on_side = at(0.25F, 0.0F), inside = at(0.5F, 0.25F);
  ASSERT_LT(inside, grid.positions.size());
  EXPECT_TRUE(legal(grid, side, next_on_side));
  EXPECT_FALSE(legal(grid, side, inside));
  EXPECT_TRUE(legal(grid, inside, side));  // the other way round nothing of the boundary is lost
}

TEST(KeepsTopology, NotAcrossANeckOfTwoBoundaryVertices) {
  // A strip one triangle wide: merging both sides of an inner rung would pinch the strip.
  TriangleMesh strip;
  strip.positions = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 0}, {2, 1, 0}};
  strip.triangles = {{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}};
  EXPECT_FALSE(legal(strip, 2, 3));
  EXPECT_TRUE(legal(strip, 2, 4));
}

TEST(KeepsTopology, NotWhereFansMeetInAPoint) {
  const TriangleMesh bow_tie = test::bow_tie();
  EXPECT_FALSE(legal(bow_tie, 0, 1));
}

TEST(KeepsTopology, SpineOfABookMovesOnlyAlongTheSpine) {
  // Three pages along the spine 0-1-2: pages are quads 0-1-a-b split in two, for each half.
  TriangleMesh book;
  book.positions = {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}};
  for (int page = 0; page < 3; ++page) {
    const auto first = static_cast<VertexId>(book.positions.size());
    const glm::vec3 out(page == 0 ? 1 : -1, page - 1, 0);
    for (int k = 0; k < 3; ++k) book.positions.push_back(out + glm::vec3(0, 0, k));
    for (VertexId k = 0; k < 2; ++k) {
      book.triangles.emplace_back(k, k + 1, first + k);
      book.triangles.emplace_back(first + k, k + 1, first + k + 1);
    }
  }
  EXPECT_TRUE(legal(book, 1, 0));
  EXPECT_FALSE(legal(book, 1, 3));  // into a page
}

TEST(KeepsOrientation, NotWhenAFaceTurnsOver) {
  // v = 0 in the middle of a concave fan; moving it to 3, beyond the dent at 2, turns the face (0, 1, 2) over.
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {-1, -1, 0}, {0.1F, -0.1F, 0}, {1, -1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
  const StarMesh stars(mesh.triangles, mesh.vertex_count());
  EXPECT_FALSE(keeps_orientation(stars, mesh.positions, 0, 3));
  EXPECT_TRUE(keeps_orientation(stars, mesh.positions, 0, 2));
}

}  // namespace
}  // namespace occlod
