#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "occlod/base.h"
#include "occlod/mesh.h"
#include "support/meshes.h"
#include "support/wedges.h"

namespace occlod {
namespace {

// The unit cube: eight vertices, two triangles a side.
TriangleMesh cube() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

glm::vec3 face_normal(const TriangleMesh& mesh, const Triangle& t) {
  return glm::normalize(
      glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
}

// Sides meet at a right angle: below it every corner has its side's normal, and each vertex three wedges.
TEST(Crease, PartsTheSidesOfACube) {
  for (const double degrees : {0.0, 45.0, 89.9}) {
    const TriangleMesh mesh = crease_normals(cube(), degrees);
    EXPECT_EQ(test::wedge_problem(mesh), "");
    EXPECT_EQ(mesh.vertex_count(), 8U);
    EXPECT_EQ(mesh.wedge_count(), 24U);
    EXPECT_EQ(mesh.triangles, cube().triangles);
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(mesh.normals[mesh.corners[t][k]], face_normal(mesh, mesh.triangles[t])) << degrees;
  }
}

// From a right angle on all three sides of a corner are one. They have one or two triangles there, of one area: the
// normal lies within the octant, and nothing is parted.
TEST(Crease, SmoothsACubeFromItsAngleOn) {
  for (const double degrees : {90.0, 180.0}) {
    const TriangleMesh mesh = crease_normals(cube(), degrees);
    EXPECT_TRUE(mesh.extra_wedges.empty()) << degrees;
    for (std::size_t v = 0; v < 8; ++v)
      for (int k = 0; k < 3; ++k) EXPECT_GT(mesh.normals[v][k] * (mesh.positions[v][k] - 0.5F), 0.0F);
  }
}

// Area counts, not the number of triangles: at the apex two large triangles of the ground against one small wall.
TEST(Crease, WeighsByArea) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {3, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};  // +z of area 1.5, +x of area 0.5
  const TriangleMesh smooth = crease_normals(mesh, 120.0);
  EXPECT_NEAR(smooth.normals[0].z / smooth.normals[0].x, 3.0F, 1e-6F);
  EXPECT_EQ(smooth.normals[1], glm::vec3(0, 0, 1));
}

// A crease that ends within a surface parts nothing at its last vertex: there is a way round it.
TEST(Crease, GoesRoundTheEndOfAnEdge) {
  // A fan of eight in a plane but for one raised rim vertex: its two triangles tilt against each other and both
  // neighbours. Only edges steeper than 40 degrees part, which is the one in the middle.
  TriangleMesh mesh = test::fan(8);
  const VertexId raised = mesh.triangles[0].y == 0 ? mesh.triangles[0].z : mesh.triangles[0].y;
  mesh.positions[raised].z = 0.35F;
  double steepest = 0.0, next = 0.0;
  for (std::size_t a = 0; a < 8; ++a) {
    const glm::vec3 m = face_normal(mesh, mesh.triangles[a]), n = face_normal(mesh, mesh.triangles[(a + 1) % 8]);
    const double angle = std::acos(std::min(1.0, static_cast<double>(glm::dot(m, n)))) * 57.29577951308232;
    next = angle > steepest ? steepest : std::max(next, angle);
    steepest = std::max(steepest, angle);
  }
  ASSERT_GT(steepest, next + 1.0);
  const TriangleMesh parted = crease_normals(mesh, (steepest + next) / 2.0);
  EXPECT_EQ(test::wedge_problem(parted), "");
  EXPECT_EQ(parted.extra_wedges, std::vector<VertexId>{raised});  // and not the centre
}

// Three pages at one edge belong to no common surface, whatever the angle.
TEST(Crease, PartsWhereThreeTrianglesMeet) {
  const TriangleMesh mesh = crease_normals(test::book(3), 180.0);
  EXPECT_EQ(mesh.extra_wedges, (std::vector<VertexId>{0, 0, 1, 1}));
}

// Texture coordinates and materials stay at their corners.
TEST(Crease, KeepsOtherAttributes) {
  TriangleMesh mesh = cube();
  for (const glm::vec3& p : mesh.positions) mesh.texture_coordinates.emplace_back(p.x + p.z, p.y);
  mesh.materials.resize(2);
  mesh.triangle_materials = {0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0};
  mesh = clean(mesh, {}, "cube").mesh;
  const std::vector<test::Corner> before = test::corners_of(mesh);
  const TriangleMesh creased = crease_normals(mesh, 30.0);
  EXPECT_EQ(test::wedge_problem(creased), "");
  std::vector<test::Corner> after = test::corners_of(creased);
  for (test::Corner& corner : after) corner.normal = glm::vec3(0.0F);
  EXPECT_EQ(after, before);
  EXPECT_EQ(creased.materials, mesh.materials);
}

TEST(Crease, TakesLargeFansAndFlatTriangles) {
  const TriangleMesh fan = crease_normals(test::fan(50'000), 10.0);
  EXPECT_TRUE(fan.extra_wedges.empty());
  TriangleMesh flat = test::grid(2, 1);
  flat.positions[1] = {0.5F, 0.0F, 0.0F};
  flat.triangles.emplace_back(0, 1, 2);  // on one line
  for (const glm::vec3& normal : crease_normals(flat, 0.0).normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
}

TEST(Crease, RefusesOtherAngles) {
  for (const double degrees : {-1.0, 180.5, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(static_cast<void>(crease_normals(cube(), degrees)), Error) << degrees;
}

}  // namespace
}  // namespace occlod
