#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "splits/collapse_rules.h"
#include "support/meshes.h"

namespace occlod {
namespace {

double bound(const TriangleMesh& mesh, VertexId v, VertexId u) {
  const StarMesh stars(mesh.triangles, mesh.vertex_count());
  VertexRing ring;
  ring.gather(stars, v);
  ChangeBound change;
  return change(mesh.positions, ring, u);
}

// A fan of n faces round vertex 0 at the given height above a regular polygon of radius 1.
TriangleMesh tent(int n, float height) {
  TriangleMesh mesh = test::fan(n);
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / n;
    mesh.positions[static_cast<std::size_t>(i) + 1] = {std::cos(angle), std::sin(angle), 0.0};
  }
  mesh.positions[0] = {0, 0, height};
  return mesh;
}

TEST(ChangeBound, ApexOfATentFallsByItsHeight) {
  // Projected along the axis, the flat polygon lies below the tent; the largest height between them is at the apex.
  for (const float height : {0.1F, 0.5F}) EXPECT_NEAR(bound(tent(8, height), 0, 1), height, 1e-6);
}

TEST(ChangeBound, ZeroOnAPlane) { EXPECT_LT(bound(tent(7, 0.0F), 0, 1), 1e-9); }

TEST(ChangeBound, NeverMoreThanTheEdgeCollapsed) {
  // A spike: its fans do not project onto each other to any use, but sliding its tip down an edge moves nothing
  // further.
  const TriangleMesh spike = tent(6, 50.0F);
  EXPECT_LE(bound(spike, 0, 1), std::sqrt(1.0 + 2500.0) * (1.0 + 1e-9));
}

TEST(ChangeBound, BoundaryVertexMovesToItsLinesNewCourse) {
  // Vertex 1 sticks out of the straight line 0-2 by h; the flat half disc below it loses the triangle 0-1-2.
  const float h = 0.125F;
  TriangleMesh mesh;
  mesh.positions = {{-1, 0, 0}, {0, h, 0}, {1, 0, 0}, {0, -1, 0}};
  mesh.triangles = {{0, 3, 1}, {3, 2, 1}};
  EXPECT_NEAR(bound(mesh, 1, 0), h, 1e-6);
}

}  // namespace
}  // namespace occlod
