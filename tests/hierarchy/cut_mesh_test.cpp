#include <gtest/gtest.h>

#include <cmath>

#include "occlod/build_hierarchy.h"
#include "occlod/mesh.h"
#include "splits/star.h"
#include "support/meshes.h"

namespace occlod {
namespace {

Hierarchy build(const TriangleMesh& mesh, std::size_t base_triangles) {
  BuildOptions options;
  options.base_triangles = base_triangles;
  return build_hierarchy(mesh, options);
}

// Every dependency of an applied split is applied.
bool is_closed(const Hierarchy& hierarchy, const FixedCut& cut) {
  for (SplitId s = 0; s < hierarchy.split_count(); ++s)
    for (const SplitId needed : star_of(hierarchy, s).dependencies())
      if (cut.applied[s] && !cut.applied[needed]) return false;
  return true;
}

TEST(CutMesh, FullCutIsTheInput) {
  const TriangleMesh mesh = test::noisy_sphere(3, 1);
  const Hierarchy hierarchy = build(mesh, 20);
  const FixedCut cut = full_cut(hierarchy);
  EXPECT_EQ(cut.splits, hierarchy.split_count());
  EXPECT_EQ(cut.triangles, mesh.triangle_count());
  EXPECT_EQ(cut.guaranteed_error, 0.0F);  // nothing is missing
  EXPECT_EQ(cut.error, 0.0F);
  EXPECT_TRUE(restores(hierarchy, cut_mesh(hierarchy, cut)));
}

// On a closed surface of genus 0 every split brings one vertex and two triangles, and a closed mesh of that kind with T
// triangles has T / 2 + 2 vertices (Euler).
TEST(CutMesh, TrianglesAreCountedExactly) {
  const Hierarchy hierarchy = build(test::noisy_sphere(3, 1), 20);
  const std::size_t base = hierarchy.base_triangle_count();
  for (const std::size_t extra : {0U, 1U, 2U, 3U, 100U}) {
    const FixedCut cut = cut_to_triangles(hierarchy, base + extra);
    EXPECT_EQ(cut.splits, extra / 2);
    EXPECT_EQ(cut.triangles, base + extra / 2 * 2);
    const TriangleMesh mesh = cut_mesh(hierarchy, cut);
    EXPECT_EQ(mesh.triangle_count(), cut.triangles);
    EXPECT_EQ(mesh.vertex_count(), cut.triangles / 2 + 2);
    MeshReport report;
    count_topology(mesh, report);
    EXPECT_EQ(report.boundary_edges, 0U);
    EXPECT_EQ(report.nonmanifold_edges, 0U);
  }
}

TEST(CutMesh, BaseMeshWhenItHasTooMany) {
  const Hierarchy hierarchy = build(test::torus(16, 8), 60);
  const FixedCut cut = cut_to_triangles(hierarchy, hierarchy.base_triangle_count() - 1);
  EXPECT_EQ(cut.splits, 0U);
  EXPECT_EQ(cut.triangles, hierarchy.base_triangle_count());
  EXPECT_EQ(cut.guaranteed_error, hierarchy.error_bound());
}

TEST(CutMesh, ErrorCutIsTheSmallestThatPromises) {
  const Hierarchy hierarchy = build(test::noisy_sphere(4, 2), 20);
  for (const float share : {0.5F, 0.1F, 0.01F}) {
    const float allowed = share * hierarchy.error_bound();
    const FixedCut cut = cut_to_error(hierarchy, allowed);
    EXPECT_TRUE(is_closed(hierarchy, cut));
    EXPECT_LE(cut.guaranteed_error, allowed);
    EXPECT_EQ(triangles_of(hierarchy, cut).size(), cut.triangles);
    // A split that promises more than is allowed cannot be left out, and no other one is in.
    for (SplitId s = 0; s < hierarchy.split_count(); ++s)
      EXPECT_EQ(cut.applied[s], hierarchy.node(s).guaranteed_error > allowed) << s;
    MeshReport report;
    count_topology(cut_mesh(hierarchy, cut), report);
    EXPECT_EQ(report.boundary_edges, 0U);  // a crack would be one
  }
}

// What is exactly allowed need not be refined: the error bound itself gives the base mesh.
TEST(CutMesh, ErrorBoundGivesTheBaseMesh) {
  const Hierarchy hierarchy = build(test::noisy_sphere(3, 3), 20);
  EXPECT_EQ(cut_to_error(hierarchy, hierarchy.error_bound()).splits, 0U);
  const float less = std::nextafter(hierarchy.error_bound(), 0.0F);
  EXPECT_GT(cut_to_error(hierarchy, less).splits, 0U);
}

TEST(CutMesh, AttributesComeAlong) {
  TriangleMesh mesh = test::grid(8, 8);
  for (const glm::vec3& p : mesh.positions) {
    mesh.normals.emplace_back(0.0F, 0.0F, 1.0F);
    mesh.colors.emplace_back(static_cast<std::uint8_t>(8.0F * p.x), static_cast<std::uint8_t>(8.0F * p.y), 7, 255);
  }
  const Hierarchy hierarchy = build(mesh, 8);
  const TriangleMesh cut = cut_mesh(hierarchy, cut_to_triangles(hierarchy, 40));
  ASSERT_EQ(cut.normals.size(), cut.vertex_count());
  ASSERT_EQ(cut.colors.size(), cut.vertex_count());
  EXPECT_LT(cut.vertex_count(), mesh.vertex_count());
  for (std::size_t i = 0; i < cut.vertex_count(); ++i) {
    EXPECT_EQ(cut.colors[i].r, static_cast<std::uint8_t>(8.0F * cut.positions[i].x));
    EXPECT_EQ(cut.colors[i].g, static_cast<std::uint8_t>(8.0F * cut.positions[i].y));
    EXPECT_EQ(cut.normals[i].z, 1.0F);
  }
}

}  // namespace
}  // namespace occlod
