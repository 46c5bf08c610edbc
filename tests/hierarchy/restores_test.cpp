#include <gtest/gtest.h>

#include <algorithm>

#include "occlod/build_hierarchy.h"
#include "support/meshes.h"

namespace occlod {
namespace {

TEST(Restores, ComparesTrianglesNotTheirOrder) {
  TriangleMesh mesh = test::noisy_sphere(2, 1);
  const Hierarchy hierarchy = build_hierarchy(mesh);
  std::reverse(mesh.triangles.begin(), mesh.triangles.end());
  Triangle& t = mesh.triangles[3];
  t = {t.y, t.z, t.x};  // the same triangle, told from another corner
  EXPECT_TRUE(restores(hierarchy, mesh));
}

TEST(Restores, SeesEveryDifference) {
  const TriangleMesh mesh = test::noisy_sphere(2, 1);
  const Hierarchy hierarchy = build_hierarchy(mesh);
  TriangleMesh turned = mesh;
  std::swap(turned.triangles[3].x, turned.triangles[3].y);
  EXPECT_FALSE(restores(hierarchy, turned));
  TriangleMesh moved = mesh;
  moved.positions[5].x += 1e-6F;
  EXPECT_FALSE(restores(hierarchy, moved));
  TriangleMesh fewer = mesh;
  fewer.triangles.pop_back();
  EXPECT_FALSE(restores(hierarchy, fewer));
  TriangleMesh doubled = mesh;
  doubled.triangles[3] = doubled.triangles[4];
  EXPECT_FALSE(restores(hierarchy, doubled));
}

TEST(Restores, CountsRepeatedTriangles) {
  TriangleMesh mesh = test::tetrahedron();
  mesh.triangles.push_back(mesh.triangles[0]);
  EXPECT_TRUE(restores(build_hierarchy(mesh), mesh));
  EXPECT_FALSE(restores(build_hierarchy(mesh), test::tetrahedron()));
}

}  // namespace
}  // namespace occlod
