// What clean() makes of vertices that differ in more than their position.
#include "support/wedges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "occlod/base.h"
#include "occlod/mesh.h"
#include "support/meshes.h"

namespace occlod {
namespace {

using test::corners_of;
using test::wedge_problem;

// The unit square as two triangles that share no vertex: 0-1-2 and 3-4-5, with 3 = 0 and 4 = 2 in position.
TriangleMesh split_square() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  return mesh;
}

CleanMesh cleaned(const TriangleMesh& mesh) {
  CleanMesh result = clean(mesh, {}, "test");
  EXPECT_EQ(wedge_problem(result.mesh), "");
  // Cleaning again changes nothing.
  const CleanMesh again = clean(result.mesh, {}, "test");
  EXPECT_EQ(corners_of(again.mesh), corners_of(result.mesh));
  EXPECT_EQ(again.mesh.extra_wedges, result.mesh.extra_wedges);
  EXPECT_EQ(again.mesh.corners, result.mesh.corners);
  EXPECT_EQ(again.report.vertices_welded, 0U);
  EXPECT_EQ(again.report.unreferenced_vertices, 0U);
  return result;
}

// Every corner with the attributes of its vertex, as drawn before cleaning.
TEST(Wedges, KeepEachCornersAttributes) {
  TriangleMesh mesh = split_square();
  mesh.normals.assign(6, {0, 0, 1});
  mesh.normals[3] = {1, 0, 0};
  mesh.colors.assign(6, {10, 10, 10, 255});
  mesh.colors[4] = {21, 10, 10, 255};
  mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  const CleanMesh result = cleaned(mesh);
  EXPECT_EQ(corners_of(result.mesh), corners_of(mesh));
  // Vertex 0 differs in its normal, 2 in its colour.
  EXPECT_EQ(result.mesh.extra_wedges, (std::vector<VertexId>{0, 2}));
  EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(result.mesh.corners, (std::vector<Triangle>{{0, 1, 2}, {4, 5, 3}}));
  EXPECT_EQ(result.mesh.vertex_count(), 4U);
  EXPECT_EQ(result.report.seam_vertices, 2U);
  EXPECT_EQ(result.report.vertices_welded, 2U);
}

// Texture coordinates alone part a vertex, also by the last bit; +0 and -0 are one, as positions are.
TEST(Wedges, PartAtTheLastBitButNotAtTheSignOfZero) {
  TriangleMesh mesh = split_square();
  mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {-0.0F, 0}, {1, std::nextafter(1.0F, 2.0F)}, {0, 1}};
  EXPECT_EQ(cleaned(mesh).mesh.extra_wedges, std::vector<VertexId>{2});
}

TEST(Wedges, AreNoneWhereAllAgrees) {
  TriangleMesh mesh = split_square();
  mesh.normals.assign(6, {0, 0, 3});
  mesh.texture_coordinates.assign(6, {0.25F, 4.0F});
  mesh.materials.resize(3);
  mesh.triangle_materials = {2, 2};
  const CleanMesh result = cleaned(mesh);
  EXPECT_TRUE(result.mesh.extra_wedges.empty());
  EXPECT_TRUE(result.mesh.corners.empty());
  EXPECT_EQ(result.mesh.normals, std::vector<glm::vec3>(4, {0, 0, 1}));
  EXPECT_EQ(result.mesh.triangle_materials, (std::vector<MaterialId>{2, 2}));
  EXPECT_EQ(result.report.seam_vertices, 0U);
}

// Two triangles that share the edge 1-2: both ends are there once for each material.
TEST(Wedges, BelongToOneMaterial) {
  TriangleMesh mesh = test::grid(1, 1);
  mesh.materials.resize(2);
  mesh.triangle_materials = {1, 0};
  const CleanMesh result = cleaned(mesh);
  EXPECT_EQ(result.report.seam_vertices, 2U);
  EXPECT_EQ(result.mesh.wedge_count(), 6U);
  mesh.triangle_materials = {0, 0};  // says nothing
  EXPECT_TRUE(cleaned(mesh).mesh.triangle_materials.empty());
  EXPECT_TRUE(cleaned(mesh).mesh.extra_wedges.empty());
}

// Materials and textures that nobody uses stay where they are.
TEST(Wedges, KeepUnusedMaterials) {
  TriangleMesh mesh = test::grid(1, 1);
  mesh.materials.resize(3);
  mesh.materials[1].texture = 1;
  mesh.textures.resize(2);
  mesh.texture_origin = TextureOrigin::top_left;
  const TriangleMesh result = cleaned(mesh).mesh;
  EXPECT_EQ(result.materials, mesh.materials);
  EXPECT_EQ(result.textures, mesh.textures);
  EXPECT_EQ(result.texture_origin, TextureOrigin::top_left);
}

// The first in the order of triangles is at the vertex; the others follow by vertex, then in that order.
TEST(Wedges, FollowTheOrderOfTheirFirstUse) {
  TriangleMesh mesh;
  const glm::vec3 p[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  const auto add = [&](int vertex, float u) {
    mesh.positions.push_back(p[vertex]);
    mesh.texture_coordinates.emplace_back(u, 0);
    return static_cast<VertexId>(mesh.positions.size() - 1);
  };
  // Vertex 0 has 5 in the first and last triangle, 7 in the second, 6 in the third; vertex 1 has 1 and 9.
  const VertexId at_7 = add(0, 7), at_6 = add(0, 6), at_5 = add(0, 5);
  const VertexId a = add(1, 1), b = add(2, 2), c = add(3, 3), d = add(4, 4), other_a = add(1, 9);
  mesh.triangles = {{at_5, a, b}, {at_7, b, c}, {at_6, c, d}, {at_5, d, other_a}};
  const TriangleMesh result = cleaned(mesh).mesh;
  EXPECT_EQ(result.vertex_count(), 5U);
  EXPECT_EQ(result.extra_wedges, (std::vector<VertexId>{0, 0, 1}));
  const std::vector<glm::vec2> expected = {{5, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {7, 0}, {6, 0}, {9, 0}};
  EXPECT_EQ(result.texture_coordinates, expected);
  EXPECT_EQ(corners_of(result), corners_of(mesh));
}

// One position, 300 triangles round it, each with a texture coordinate of its own.
TEST(Wedges, AVertexMayHaveThreeHundred) {
  TriangleMesh mesh = test::fan(300);
  mesh.texture_coordinates.resize(mesh.vertex_count());
  for (std::size_t t = 0; t < 300; ++t) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.triangles[t][k] != 0) continue;
      mesh.triangles[t][k] = static_cast<VertexId>(mesh.positions.size());
      mesh.positions.emplace_back(mesh.positions[0]);
      mesh.texture_coordinates.emplace_back(static_cast<float>(t), 0.5F);
    }
  }
  const CleanMesh result = cleaned(mesh);
  EXPECT_EQ(result.mesh.extra_wedges, std::vector<VertexId>(299, 300));  // behind the 300 of the rim
  EXPECT_EQ(corners_of(result.mesh), corners_of(mesh));
  EXPECT_EQ(result.report.seam_vertices, 1U);
}

// Along the cut of a Moebius strip the texture meets itself turned over: both ends of one edge have two wedges.
TEST(Wedges, OfAMoebiusStrip) {
  const TriangleMesh strip = test::moebius(12);
  TriangleMesh mesh = strip;
  mesh.positions.clear();
  for (std::size_t t = 0; t < strip.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const VertexId v = strip.triangles[t][k];
      mesh.triangles[t][k] = static_cast<VertexId>(mesh.positions.size());
      mesh.positions.push_back(strip.positions[v]);
      // The last cell meets the first vertex of either side (0 and 12) again, on the other side.
      const bool again = v % 12 == 0 && t + 2 >= strip.triangle_count();
      const auto side = static_cast<float>(v / 12);
      mesh.texture_coordinates.emplace_back(again ? 1.0F : static_cast<float>(v % 12) / 12.0F,
                                            again ? 1.0F - side : side);
    }
  }
  const CleanMesh result = cleaned(mesh);
  EXPECT_EQ(result.mesh.vertex_count(), strip.vertex_count());
  EXPECT_EQ(result.mesh.extra_wedges, (std::vector<VertexId>{0, 3}));  // the first cell is 0 1 13, 0 13 12
  EXPECT_EQ(corners_of(result.mesh), corners_of(mesh));
}

// Three pages at one edge, each a chart of its own.
TEST(Wedges, OfThreeChartsAtANonManifoldEdge) {
  const TriangleMesh book = test::book(3);
  TriangleMesh mesh;
  for (std::size_t t = 0; t < 3; ++t) {
    const auto first = static_cast<VertexId>(mesh.positions.size());
    for (int k = 0; k < 3; ++k) {
      mesh.positions.push_back(book.positions[book.triangles[t][k]]);
      mesh.texture_coordinates.emplace_back(static_cast<float>(t), static_cast<float>(k));
    }
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  const CleanMesh result = cleaned(mesh);
  EXPECT_EQ(result.mesh.triangles, book.triangles);
  EXPECT_EQ(result.mesh.extra_wedges, (std::vector<VertexId>{0, 0, 1, 1}));
  EXPECT_EQ(result.report.nonmanifold_edges, 1U);
}

TEST(Wedges, RepairTextureCoordinatesThatAreNotFinite) {
  TriangleMesh mesh = test::grid(1, 1);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  mesh.positions.emplace_back(9, 9, 9);  // not used: does not count
  mesh.texture_coordinates = {{0, 0}, {nan, 0.5F}, {0, 1}, {1, -std::numeric_limits<float>::infinity()}, {nan, nan}};
  const CleanMesh result = cleaned(mesh);
  EXPECT_EQ(result.mesh.texture_coordinates, (std::vector<glm::vec2>{{0, 0}, {0, 0}, {0, 1}, {0, 0}}));
  EXPECT_EQ(result.report.left_out.count("texture coordinates that are not finite"), 2U);
}

// A normal that cannot be used becomes that of all triangles at its position, also of those of other wedges: here one
// of two triangles that stand at a right angle.
TEST(Wedges, TakeMissingNormalsFromAllTrianglesOfTheVertex) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};  // facing +z and +x
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  const TriangleMesh result = cleaned(mesh).mesh;
  const float half = static_cast<float>(1.0 / std::sqrt(2.0));
  EXPECT_EQ(result.normals[result.corners[1].x], glm::vec3(half, 0, half));
  EXPECT_EQ(result.extra_wedges, (std::vector<VertexId>{0, 2}));
}

// Single precision cannot hold most directions with length 1. What it makes of them stays as it is.
TEST(Wedges, KeepTheBitsOfNormalsOfUnitLength) {
  std::mt19937 random(1);
  std::normal_distribution<float> component;
  TriangleMesh mesh = test::fan(20'000);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const glm::vec3 n(component(random), component(random), component(random));
    const float length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    mesh.normals.push_back(n / length);
  }
  EXPECT_EQ(clean(mesh, {}, "fan").mesh.normals, mesh.normals);
  const std::vector<glm::vec3> unit = mesh.normals;
  for (glm::vec3& n : mesh.normals) n *= 1.5F;
  const std::vector<glm::vec3> once = clean(mesh, {}, "fan").mesh.normals;
  for (std::size_t v = 0; v < unit.size(); ++v) EXPECT_NEAR(glm::dot(once[v], unit[v]), 1.0F, 1e-6F);
  mesh.normals = once;
  EXPECT_EQ(clean(mesh, {}, "fan").mesh.normals, once);
}

// A triangle that goes takes the wedges with it that only it used, and its material.
TEST(Wedges, GoWithTheirTriangles) {
  TriangleMesh mesh = split_square();
  mesh.positions.emplace_back(1, 1, 0);  // 6 = 2 in position
  mesh.texture_coordinates.assign(7, {0, 0});
  mesh.texture_coordinates[6] = {9, 9};
  mesh.triangles.insert(mesh.triangles.begin() + 1, {2, 6, 5});  // two corners at (1, 1, 0)
  mesh.materials.resize(3);
  mesh.triangle_materials = {1, 2, 1};
  const CleanMesh result = cleaned(mesh);
  EXPECT_TRUE(result.mesh.extra_wedges.empty());
  EXPECT_EQ(result.mesh.triangle_materials, (std::vector<MaterialId>{1, 1}));
  EXPECT_EQ(result.report.repeated_index_triangles, 1U);
}

TEST(Wedges, RefuseMaterialsThatAreNotThere) {
  TriangleMesh no_material = test::grid(1, 1);
  no_material.materials.resize(1);
  no_material.triangle_materials = {0, 1};
  TriangleMesh no_texture_there = test::grid(1, 1);
  no_texture_there.materials.resize(2);
  no_texture_there.materials[1].texture = 0;
  const auto place_of = [](const TriangleMesh& mesh) {
    try {
      static_cast<void>(clean(mesh, {}, "it"));
    } catch (const Error& error) {
      return error.diagnosis().place;
    }
    return std::string("accepted");
  };
  EXPECT_EQ(place_of(no_material), "triangle 1");
  EXPECT_EQ(place_of(no_texture_there), "material 1");
}

// (0, 0, 1) and (1, 0, 0): the diagonal between. (10 + 21) / 2 = 15.5, rounded up.
TEST(MergeWedges, AveragesNormalsAndColours) {
  TriangleMesh mesh = split_square();
  mesh.normals.assign(6, {0, 0, 1});
  mesh.normals[3] = {1, 0, 0};
  mesh.colors.assign(6, {10, 10, 10, 255});
  mesh.colors[4] = {21, 10, 10, 255};
  mesh.texture_coordinates.assign(6, {0, 0});
  const TriangleMesh merged = merge_wedges(cleaned(mesh).mesh);
  EXPECT_EQ(wedge_problem(merged), "");
  EXPECT_EQ(merged.wedge_count(), 4U);
  EXPECT_FLOAT_EQ(merged.normals[0].x, std::sqrt(0.5F));
  EXPECT_FLOAT_EQ(merged.normals[0].z, std::sqrt(0.5F));
  EXPECT_EQ(merged.colors[2], glm::u8vec4(16, 10, 10, 255));
  EXPECT_EQ(merged.colors[1], glm::u8vec4(10, 10, 10, 255));
  EXPECT_TRUE(merged.texture_coordinates.empty());
}

TEST(MergeWedges, KeepsTheFirstWhereNormalsCancelOut) {
  TriangleMesh mesh = split_square();
  mesh.normals.assign(6, {0, 0, 1});
  mesh.normals[3] = {0, 0, -1};
  EXPECT_EQ(merge_wedges(cleaned(mesh).mesh).normals[0], glm::vec3(0, 0, 1));
}

}  // namespace
}  // namespace occlod
