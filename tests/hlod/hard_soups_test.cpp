// Soups that no octree likes. Each builds, validates and comes back.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "occlod/build_hlod.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"
#include "support/meshes.h"

namespace occlod::hlod {
namespace {

using occlod::test::append;

void expect_sound(const TriangleMesh& mesh, std::uint32_t node_triangles = 64) {
  for (const Grouping grouping : {Grouping::shifted, Grouping::nested})
    for (const Borders borders : {Borders::locked, Borders::free}) {
      if (grouping == Grouping::shifted && borders == Borders::free) continue;
      HlodBuildOptions options;
      options.node_triangles = node_triangles;
      options.grouping = grouping;
      options.borders = borders;
      options.within = Within::splits;
      const Hlod hlod = build_hlod(mesh, options);
      const std::vector<std::string> violations = validate(hlod, 200);
      EXPECT_TRUE(violations.empty()) << violations[0];
      EXPECT_TRUE(restores(hlod, mesh));
    }
}

void append_triangle(TriangleMesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const auto first = static_cast<VertexId>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.triangles.emplace_back(first, first + 1, first + 2);
}

TriangleMesh cleaned(const TriangleMesh& mesh) { return clean(mesh, {}, "test mesh").mesh; }

TEST(HardSoups, ThousandsOfComponents) { expect_sound(occlod::test::many_tetrahedra(5139)); }

TEST(HardSoups, OneVertexOfAHundredThousandTriangles) { expect_sound(occlod::test::fan(100'000), 2000); }

TEST(HardSoups, AllTrianglesInOneCell) {
  // 1,000 triangles of three values of each coordinate around one middle: no cell separates their centroids.
  TriangleMesh mesh;
  for (int i = 0; i < 1000; ++i) {
    const float a = std::cos(static_cast<float>(i)), b = std::sin(static_cast<float>(i));
    const float c = static_cast<float>(i % 17) * 0.01F;
    append_triangle(mesh, {a, b, c}, {-b, a, -c}, {b - a, -a - b, 0.0F});
  }
  expect_sound(cleaned(mesh));
}

TEST(HardSoups, CoplanarDuplicates) {
  // Each triangle of a grid up to five times, some of them turned over. Locked vertices lose all their triangles in
  // some nodes and keep them in others: fronts crack unless these stay locked for ever.
  TriangleMesh mesh = occlod::test::grid(30, 30);
  const std::vector<Triangle> once = mesh.triangles;
  for (std::size_t i = 0; i < once.size(); ++i)
    for (std::size_t k = 0; k < i % 5; ++k)
      mesh.triangles.push_back(k % 2 == 0 ? once[i] : Triangle(once[i].y, once[i].x, once[i].z));
  expect_sound(mesh);
}

TEST(HardSoups, NeedlesAcrossAllCells) {
  TriangleMesh mesh = occlod::test::noisy_sphere(4, 1);
  std::mt19937_64 random(2);
  const auto number = [&] { return static_cast<float>(random() % 2001) / 1000.0F - 1.0F; };
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 p(number(), number(), number());
    append_triangle(mesh, p, -p, -p + glm::vec3(0.0F, 1e-4F, 0.0F));
  }
  expect_sound(cleaned(mesh));
}

TEST(HardSoups, TrianglesWithoutArea) {
  TriangleMesh mesh;
  for (int i = 0; i < 400; ++i) mesh.positions.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
  for (VertexId v = 0; v + 2 < mesh.positions.size(); ++v) mesh.triangles.push_back({v, v + 1, v + 2});
  expect_sound(mesh, 16);
}

// A curved sheet of 60 x 60 cells in which every n-th triangle lies there twice, in either winding.
TriangleMesh sheet_with_doubles(std::size_t n, bool turned) {
  TriangleMesh mesh = occlod::test::grid(60, 60);
  for (glm::vec3& p : mesh.positions) p.z = 0.05F * std::sin(3.0F * p.x) * std::cos(4.0F * p.y);
  const std::vector<Triangle> once = mesh.triangles;
  for (std::size_t i = 0; i < once.size(); i += n)
    mesh.triangles.push_back(turned ? Triangle(once[i].y, once[i].x, once[i].z) : once[i]);
  return mesh;
}

TEST(HardSoups, SheetsWithDoublesHaveCoarseLevels) {
  for (const std::size_t n : {std::size_t{1}, std::size_t{20}})
    for (const bool turned : {false, true}) {
      const TriangleMesh mesh = sheet_with_doubles(n, turned);
      expect_sound(mesh, 500);
      HlodBuildOptions options;
      options.node_triangles = 500;
      options.grouping = Grouping::nested;
      options.borders = Borders::free;
      const Hlod hlod = build_hlod(mesh, options);
      ASSERT_EQ(hlod.data().roots.size(), 1U);
      EXPECT_LE(hlod.node(hlod.data().roots[0]).triangles, 500U);
      EXPECT_NEAR(hlod.node(hlod.data().roots[0]).area, occlod::test::area_of(mesh),
                  0.05 * occlod::test::area_of(mesh));
    }
}

TEST(HardSoups, AllOpposite) {
  // Both sides of one sheet.
  TriangleMesh mesh = occlod::test::grid(20, 20);
  const std::vector<Triangle> once = mesh.triangles;
  for (const Triangle& t : once) mesh.triangles.emplace_back(t.y, t.x, t.z);
  expect_sound(mesh);
}

TEST(HardSoups, ExtremeCoordinates) {
  for (const float scale : {1e-37F, 1e-20F, 1e20F, 1e37F}) {
    TriangleMesh mesh = occlod::test::noisy_sphere(4, 1);
    for (glm::vec3& p : mesh.positions) p *= scale;
    expect_sound(cleaned(mesh));
  }
  TriangleMesh far = occlod::test::noisy_sphere(4, 1);
  for (glm::vec3& p : far.positions) p += glm::vec3(10'000.0F);
  expect_sound(cleaned(far));
}

}  // namespace
}  // namespace occlod::hlod
