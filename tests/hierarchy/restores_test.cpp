#include <gtest/gtest.h>

#include <algorithm>

#include "occlod/build_hierarchy.h"
#include "occlod/build_hlod.h"
#include "occlod/mesh.h"
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

// A mesh as a file of the other texture origin keeps it: v became 1 - v, which rounds what is below 1/2.
TriangleMesh of_other_origin(TriangleMesh mesh) {
  for (glm::vec2& at : mesh.texture_coordinates) at.y = 1.0F - at.y;
  mesh.texture_origin =
      mesh.texture_origin == TextureOrigin::bottom_left ? TextureOrigin::top_left : TextureOrigin::bottom_left;
  return mesh;
}

TEST(Restores, WhatWasWrittenWithTheOtherTextureOrigin) {
  for (const TextureOrigin origin : {TextureOrigin::bottom_left, TextureOrigin::top_left}) {
    TriangleMesh mesh = test::noisy_sphere(2, 1);
    mesh.texture_origin = origin;
    for (const glm::vec3& p : mesh.positions) mesh.texture_coordinates.emplace_back(p.x, 2.3F * p.y + 0.1F);
    const TriangleMesh written = of_other_origin(mesh);
    // Most coordinates have more digits than 1 - v has.
    EXPECT_NE(of_other_origin(written).texture_coordinates, mesh.texture_coordinates);
    const Hierarchy of_mesh = build_hierarchy(mesh), of_written = build_hierarchy(written);
    EXPECT_TRUE(restores(of_mesh, written));
    EXPECT_TRUE(restores(of_written, mesh));
    const hlod::Hlod nodes = hlod::build_hlod(mesh);
    EXPECT_TRUE(hlod::restores(nodes, written));
    TriangleMesh changed = written;
    changed.texture_coordinates[7].y += 1e-6F;
    EXPECT_FALSE(restores(of_mesh, changed));
    EXPECT_FALSE(hlod::restores(nodes, changed));
    changed = written;
    changed.texture_origin = origin;
    EXPECT_FALSE(restores(of_mesh, changed));
    EXPECT_FALSE(hlod::restores(nodes, changed));
  }
}

// A PLY file holds no materials but its textures.
TEST(Restores, TakesNoNoticeOfMaterialsThatTheMeshDoesNotHave) {
  TriangleMesh mesh = test::grid(4, 4);
  mesh.colors.assign(mesh.vertex_count(), glm::u8vec4(255, 0, 0, 255));
  const TriangleMesh plain = mesh;
  mesh.materials.resize(2);
  mesh.materials[1].base_color.r = 0.5F;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) mesh.triangle_materials.push_back(t < 9 ? 0 : 1);
  mesh = clean(std::move(mesh), {}, "grid").mesh;
  const Hierarchy hierarchy = build_hierarchy(mesh);
  EXPECT_TRUE(restores(hierarchy, plain));
  EXPECT_TRUE(hlod::restores(hlod::build_hlod(mesh), plain));
  std::swap(mesh.triangle_materials[8], mesh.triangle_materials[9]);
  EXPECT_FALSE(restores(hierarchy, mesh));
}

}  // namespace
}  // namespace occlod
