// Several meshes at their places as one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/ext/matrix_transform.hpp>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/mesh.h"
#include "occlod/scene.h"
#include "support/wedges.h"

namespace occlod {
namespace {

using test::Corner;
using test::corners_of;

// A square of two triangles with a seam along its diagonal, of two materials with one image.
TriangleMesh seamed_square() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}, {1, 1, 0}};
  mesh.normals.assign(6, {0, 0, 1});
  mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0.5F, 0.75F}, {0.25F, 0.5F}, {0.75F, 0.5F}};
  mesh.extra_wedges = {0, 2};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.corners = {{0, 1, 2}, {4, 5, 3}};
  mesh.triangle_materials = {0, 1};
  mesh.materials = {{"wood", glm::vec4(1.0F), 0}, {"plain", {0.5F, 0.5F, 0.5F, 1.0F}, no_texture}};
  mesh.textures = {{}};
  mesh.textures[0].file = "wood.png";
  return mesh;
}

TriangleMesh bare_triangle() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

glm::dmat4 moved(double x) { return glm::translate(glm::dmat4(1.0), {x, 0.0, 0.0}); }

TEST(JoinMeshes, OneMeshStaysAsItIs) {
  const TriangleMesh square = seamed_square();
  const PlacedMesh placed[] = {{&square, glm::dmat4(1.0), "/models/square.obj"}};
  const TriangleMesh joined = join_meshes(placed, "/models", "out");
  EXPECT_EQ(corners_of(joined), corners_of(square));
  EXPECT_EQ(joined.triangles, square.triangles);
  EXPECT_EQ(joined.corners, square.corners);
  EXPECT_EQ(joined.extra_wedges, square.extra_wedges);
  EXPECT_EQ(joined.materials, square.materials);
  EXPECT_EQ(joined.textures[0].file, "wood.png");
}

TEST(JoinMeshes, KeepsVerticesAndWedgesOfEach) {
  const TriangleMesh square = seamed_square();
  const PlacedMesh placed[] = {{&square, moved(0), "/models/square.obj"},
                               {&square, moved(5), "/models/square.obj"},
                               {&square, moved(9), "/models/other.obj"}};
  const TriangleMesh joined = join_meshes(placed, "/out", "out");
  EXPECT_EQ(test::wedge_problem(joined), "");
  EXPECT_EQ(joined.vertex_count(), 12U);
  EXPECT_EQ(joined.wedge_count(), 18U);
  const std::vector<Corner> corners = corners_of(joined), before = corners_of(square);
  ASSERT_EQ(corners.size(), 18U);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_EQ(corners[i].texture_coordinate, before[i % 6].texture_coordinate);
    EXPECT_EQ(corners[i].position.x - before[i % 6].position.x, (std::array{0.0F, 5.0F, 9.0F})[i / 6]);
  }
  // Meshes of one source share materials; a square of another file has its own.
  EXPECT_EQ(joined.triangle_materials, (std::vector<MaterialId>{0, 1, 0, 1, 2, 3}));
  ASSERT_EQ(joined.textures.size(), 2U);
  EXPECT_EQ(joined.textures[0].file, "/models/wood.png") << "elsewhere than the result";
}

TEST(JoinMeshes, NamesImagesFromWhereItIsWritten) {
  const TriangleMesh square = seamed_square();
  const PlacedMesh placed[] = {{&square, moved(0), "/out/models/square.obj"}};
  EXPECT_EQ(join_meshes(placed, "/out", "out").textures[0].file, "models/wood.png");
}

TEST(JoinMeshes, TurnsMirroredMeshesRound) {
  const TriangleMesh square = seamed_square();
  const PlacedMesh placed[] = {{&square, glm::scale(glm::dmat4(1.0), {-1.0, 1.0, 1.0}), ""}};
  const TriangleMesh joined = join_meshes(placed, "", "out");
  for (const Triangle& t : joined.triangles) {
    const glm::vec3 a = joined.positions[t.x], b = joined.positions[t.y], c = joined.positions[t.z];
    EXPECT_GT(glm::cross(b - a, c - a).z, 0.0F);
  }
  std::vector<Corner> corners = corners_of(joined), before = corners_of(square);
  for (Corner& corner : before) corner.position.x *= -1.0F;
  for (std::vector<Corner>* list : {&corners, &before})
    for (Corner& corner : *list) {  // bits are compared: no negative zero
      corner.position += 0.0F;
      corner.normal += 0.0F;
    }
  std::sort(corners.begin(), corners.end());
  std::sort(before.begin(), before.end());
  EXPECT_EQ(corners, before) << "each corner keeps its own";
}

TEST(JoinMeshes, FillsWhatSomeLack) {
  const TriangleMesh square = seamed_square(), bare = bare_triangle();
  const PlacedMesh placed[] = {{&bare, moved(0), "bare"}, {&square, moved(3), "square"}, {&bare, moved(6), "bare"}};
  const TriangleMesh joined = join_meshes(placed, "", "out");
  EXPECT_EQ(test::wedge_problem(joined), "");
  EXPECT_TRUE(joined.normals.empty());
  ASSERT_EQ(joined.texture_coordinates.size(), joined.wedge_count());
  const std::vector<Corner> corners = corners_of(joined);
  EXPECT_EQ(corners[0].texture_coordinate, glm::vec2(0.0F));
  EXPECT_EQ(corners[8].texture_coordinate, glm::vec2(0.5F, 0.75F));
  EXPECT_EQ(corners.back().texture_coordinate, glm::vec2(0.0F));
  ASSERT_EQ(joined.materials.size(), 3U);
  EXPECT_EQ(joined.materials[joined.material_of(0)], Material());
  EXPECT_EQ(joined.materials[joined.material_of(1)].name, "wood");
}

TEST(JoinMeshes, TurnsTextureCoordinatesOfAnotherOriginOver) {
  TriangleMesh square = seamed_square(), other = seamed_square();
  other.texture_origin = TextureOrigin::top_left;
  const PlacedMesh placed[] = {{&square, moved(0), "a"}, {&other, moved(3), "b"}};
  const TriangleMesh joined = join_meshes(placed, "", "out");
  EXPECT_EQ(joined.texture_origin, TextureOrigin::bottom_left);
  EXPECT_EQ(corners_of(joined)[11].texture_coordinate, glm::vec2(0.5F, 0.25F));
}

TEST(JoinMeshes, RefusesTooManyMaterials) {
  TriangleMesh many = bare_triangle();
  many.materials.resize(40'000);
  const PlacedMesh placed[] = {{&many, moved(0), "a.obj"}, {&many, moved(3), "b.obj"}};
  try {
    (void)join_meshes(placed, "", "all.glb");
    FAIL();
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("all.glb"), std::string::npos) << what;
    EXPECT_NE(what.find("b.obj"), std::string::npos) << what;
    EXPECT_NE(what.find("65,535"), std::string::npos) << what;
  }
  const PlacedMesh same[] = {{&many, moved(0), "a.obj"}, {&many, moved(3), "a.obj"}};
  EXPECT_EQ(join_meshes(same, "", "all.glb").materials.size(), 40'000U);
}

}  // namespace
}  // namespace occlod
