// Soups of which the right outcome can be told beforehand.
#include "repair/repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <random>
#include <stdexcept>
#include <vector>

#include "occlod/mesh.h"
#include "repair/repair_case.h"
#include "support/meshes.h"
#include "support/wedges.h"

namespace occlod::repair {
namespace {

void turn(Triangle& t) { std::swap(t.y, t.z); }

// Eight corners, two triangles a side, outside counter-clockwise.
TriangleMesh cube() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  for (const glm::u32vec4& side : {glm::u32vec4(0, 2, 3, 1), glm::u32vec4(4, 5, 7, 6), glm::u32vec4(0, 1, 5, 4),
                                   glm::u32vec4(2, 6, 7, 3), glm::u32vec4(0, 4, 6, 2), glm::u32vec4(1, 3, 7, 5)}) {
    mesh.triangles.emplace_back(side.x, side.y, side.z);
    mesh.triangles.emplace_back(side.x, side.z, side.w);
  }
  return mesh;
}

std::vector<test::Corner> sorted_corners(const TriangleMesh& mesh) {
  std::vector<test::Corner> corners = test::corners_of(mesh);
  std::sort(corners.begin(), corners.end());
  return corners;
}

double volume(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    sum += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
  return sum;
}

// The same corners in the same direction, told from any of them.
bool is_same(Triangle a, const Triangle& b) {
  for (int i = 0; i < 2 && a != b; ++i) a = {a.y, a.z, a.x};
  return a == b;
}

void expect_unchanged(const TriangleMesh& mesh) {
  const RepairedMesh repaired = repair_soundly(mesh);
  EXPECT_EQ(repaired.mesh.positions, mesh.positions);
  EXPECT_EQ(repaired.changes.triangles_turned + repaired.changes.vertices_duplicated + repaired.changes.dropped(), 0U);
  ASSERT_EQ(repaired.mesh.triangle_count(), mesh.triangle_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    EXPECT_TRUE(is_same(repaired.mesh.triangles[t], mesh.triangles[t]));
}

TEST(Repair, LeavesAloneWhatIsSound) {
  for (const TriangleMesh& mesh : {test::grid(5, 3), test::torus(8, 6), test::two_components(), cube()})
    expect_unchanged(mesh);
}

TEST(Repair, OfTwoPiecesWithOppositeWindingTheFirstLeads) {
  // Two squares side by side, the second turned: two triangles against two, so nothing but their order decides.
  TriangleMesh mesh = test::grid(2, 1);
  turn(mesh.triangles[2]);
  turn(mesh.triangles[3]);
  const RepairedMesh repaired = repair_soundly(mesh);
  EXPECT_EQ(repaired.changes.triangles_turned, 2U);
  for (const Triangle& t : repaired.mesh.triangles) {
    const auto& p = repaired.mesh.positions;
    EXPECT_GT(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]).z, 0.0F);
  }
}

TEST(Repair, MajorityOfACubeTurnsOneSideBack) {
  // Wherever the turned side is in the file, first or last: two triangles of twelve are turned, and the volume is 1,
  // not -1.
  for (const std::size_t side : {0U, 3U, 5U}) {
    TriangleMesh mesh = cube();
    turn(mesh.triangles[2 * side]);
    turn(mesh.triangles[2 * side + 1]);
    const RepairedMesh repaired = repair_soundly(mesh);
    EXPECT_EQ(repaired.changes.triangles_turned, 2U);
    EXPECT_EQ(repaired.changes.vertices_duplicated, 0U);
    EXPECT_DOUBLE_EQ(volume(repaired.mesh), 1.0);
  }
}

TEST(Repair, CountsRepeatedAndOppositeTrianglesApart) {
  TriangleMesh mesh = test::tetrahedron();
  const Triangle t = mesh.triangles[1];
  mesh.triangles.emplace_back(t.y, t.z, t.x);  // from another corner, in the same direction
  mesh.triangles.emplace_back(t.y, t.x, t.z);
  mesh.triangles.push_back(t);
  const RepairedMesh repaired = repair_soundly(mesh);
  EXPECT_EQ(repaired.changes.repeated_dropped, 2U);
  EXPECT_EQ(repaired.changes.opposite_dropped, 1U);
  EXPECT_EQ(repaired.mesh.triangle_count(), 4U);
  EXPECT_EQ(topology_of(repaired.mesh).boundary_edges, 0U);
}

TEST(Repair, CrackCloses) {
  // Two sheets whose edges at x = 1 lie 0.001 apart. Welded at 0.01 they share three vertices there, and the border is
  // that of one sheet of 2 x 2 cells.
  TriangleMesh mesh = test::grid(1, 2);
  test::append(mesh, test::grid(1, 2), {1.001F, 0, 0});
  EXPECT_EQ(repair_soundly(mesh).mesh.vertex_count(), 12U);
  RepairOptions options;
  options.weld = 0.01;
  const RepairedMesh repaired = repair_soundly(mesh, options);
  EXPECT_EQ(repaired.changes.vertices_welded, 3U);
  EXPECT_EQ(repaired.mesh.vertex_count(), 9U);
  EXPECT_EQ(topology_of(repaired.mesh).boundary_edges, 8U);
  EXPECT_EQ(topology_of(repaired.mesh).components, 1U);
}

TEST(Repair, WeldingCountsTrianglesThatCollapse) {
  // A sliver of the width 0.001 between two triangles: its short side goes, and the sliver with it.
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0.001F, 0}, {0.5F, -1, 0}, {0.5F, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 4}};
  RepairOptions options;
  options.weld = 0.01;
  const RepairedMesh repaired = repair_soundly(mesh, options);
  EXPECT_EQ(repaired.changes.vertices_welded, 1U);
  EXPECT_EQ(repaired.changes.collapsed_dropped, 1U);
  EXPECT_EQ(repaired.mesh.triangle_count(), 2U);
  EXPECT_EQ(topology_of(repaired.mesh).boundary_edges, 4U);  // the two triangles share the edge that was the sliver
}

TEST(Repair, MoebiusBandIsCutAcrossAndSaysSo) {
  // One edge across the band where its sides change; cut there, it is a strip: one border in place of one, both ends
  // twice.
  const TriangleMesh band = test::moebius(20);
  const RepairedMesh repaired = repair_soundly(band);
  EXPECT_EQ(repaired.changes.unorientable_edges, 1U);
  EXPECT_EQ(repaired.changes.vertices_duplicated, 2U);
  EXPECT_EQ(repaired.changes.edges_stitched, 0U);
  EXPECT_EQ(topology_of(repaired.mesh).boundary_edges, topology_of(band).boundary_edges + 2);
  EXPECT_EQ(repaired.mesh.triangle_count(), band.triangle_count());
}

TEST(Repair, BowTieAndBookComeApart) {
  const RepairedMesh bow_tie = repair_soundly(test::bow_tie());
  EXPECT_EQ(bow_tie.changes.vertices_duplicated, 1U);
  EXPECT_EQ(topology_of(bow_tie.mesh).components, 2U);
  // Five pages, each with a spine of its own: four copies of both its ends.
  const RepairedMesh book = repair_soundly(test::book(5));
  EXPECT_EQ(book.changes.vertices_duplicated, 8U);
  EXPECT_EQ(topology_of(book.mesh).components, 5U);
}

TEST(Repair, CubesThatShareAnEdgeStayClosed) {
  // Four triangles meet at an edge; each cube is a surface of its own, with its own copy of the edge.
  TriangleMesh mesh = cube();
  test::append(mesh, cube(), {1, 1, 0});
  const TriangleMesh touching = clean(mesh, {}, "cubes").mesh;
  EXPECT_EQ(topology_of(touching).nonmanifold_edges, 1U);
  const RepairedMesh repaired = repair_soundly(touching);
  EXPECT_EQ(topology_of(repaired.mesh).boundary_edges, 0U);
  EXPECT_EQ(topology_of(repaired.mesh).components, 2U);
  EXPECT_EQ(repaired.changes.vertices_duplicated, 2U);
}

// Square 0 1 2 3 cut along 0-2, where vertex 4 lies in the middle: triangle 0 2 4 has no area.
TriangleMesh square_with_flat_triangle() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5F, 0.5F, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}};
  return mesh;
}

TEST(Repair, TriangleWithoutAreaIsGivenToTheOneBeyond) {
  // 0 1 2 is cut at vertex 4 into two; the square stays whole, without a crack along its diagonal.
  const RepairedMesh repaired = repair_soundly(square_with_flat_triangle());
  EXPECT_EQ(repaired.changes.zero_area_flipped, 1U);
  EXPECT_EQ(repaired.changes.dropped() + repaired.changes.zero_area_kept, 0U);
  EXPECT_EQ(topology_of(repaired.mesh).zero_area_triangles, 0U);
  EXPECT_EQ(topology_of(repaired.mesh).boundary_edges, 4U);
  EXPECT_DOUBLE_EQ(test::area_of(repaired.mesh), 1.0);
}

TEST(Repair, TriangleWithoutAreaOnTheBorderIsDropped) {
  TriangleMesh mesh = square_with_flat_triangle();
  mesh.triangles.erase(mesh.triangles.begin());  // the longest side 0-2 is on the border now
  const RepairedMesh repaired = repair_soundly(mesh);
  EXPECT_EQ(repaired.changes.zero_area_dropped, 1U);
  EXPECT_EQ(topology_of(repaired.mesh).boundary_edges, 4U);  // 0-4, 4-2 instead of 0-2
  EXPECT_DOUBLE_EQ(test::area_of(repaired.mesh), 0.5);
}

TEST(Repair, ChainsOfTrianglesWithoutAreaGo) {
  // A fan of n - 1 triangles without area along the diagonal of a square, with a triangle beyond: each inner vertex of
  // the line becomes a corner of that one. 1 + (n - 1) triangles on that side before and after.
  const int n = 16;
  TriangleMesh mesh;
  mesh.positions = {{0, 1, 0}, {1, 0, 0}};
  for (int i = 0; i <= n; ++i) mesh.positions.emplace_back(glm::vec3(static_cast<float>(i) / n));
  for (glm::vec3& p : mesh.positions) p.z = 0;
  const auto line = [](int i) { return static_cast<VertexId>(2 + i); };
  for (int i = 0; i < n; ++i) mesh.triangles.emplace_back(line(i), line(i + 1), 0U);
  for (int i = 1; i < n; ++i) mesh.triangles.emplace_back(line(0), line(i + 1), line(i));
  mesh.triangles.emplace_back(line(n), line(0), 1U);
  const RepairedMesh repaired = repair_soundly(mesh);
  EXPECT_EQ(repaired.changes.zero_area_flipped, static_cast<std::size_t>(n - 1));
  EXPECT_EQ(topology_of(repaired.mesh).zero_area_triangles, 0U);
  EXPECT_EQ(topology_of(repaired.mesh).boundary_edges, 4U);
  EXPECT_DOUBLE_EQ(test::area_of(repaired.mesh), 1.0);
}

TEST(Repair, RandomTrianglesWithoutAreaGoOrStay) {
  // A sheet of which some rows are moved onto one line, in no order along it: triangles without area beside each other
  // in every way there is. Whatever is done to them leaves the area, and comes to an end.
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    TriangleMesh mesh = test::grid(9, 9);
    const float low = static_cast<float>(random() % 10) / 9.0F, high = low + static_cast<float>(random() % 6) / 9.0F;
    for (glm::vec3& p : mesh.positions)
      if (p.y >= low - 0.01F && p.y <= high + 0.01F) p = {static_cast<float>(random() % 1'000'000), low, 0};
    const RepairedMesh repaired = repair_soundly(mesh);
    EXPECT_NEAR(test::area_of(repaired.mesh), test::area_of(mesh), 1e-9 * test::area_of(mesh));
    EXPECT_EQ(topology_of(repaired.mesh).zero_area_triangles, repaired.changes.zero_area_kept);
  }
}

TEST(Repair, NothingButOneLineIsLeftEmpty) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}};
  mesh.triangles = {{0, 1, 2}};
  const RepairedMesh repaired = repair_soundly(mesh);
  EXPECT_EQ(repaired.changes.zero_area_dropped, 1U);
  EXPECT_TRUE(repaired.mesh.triangles.empty());
  EXPECT_TRUE(repaired.mesh.positions.empty());
}

TEST(Repair, FillsHolesUpToTheirSize) {
  // Without its lid the cube has a border of 4 edges, which two triangles close.
  TriangleMesh open = cube();
  open.triangles.erase(open.triangles.begin() + 2, open.triangles.begin() + 4);
  for (const std::size_t most : {0U, 3U, 4U, 100U}) {
    RepairOptions options;
    options.fill_holes = most;
    const RepairedMesh repaired = repair_soundly(open, options);
    const bool fills = most >= 4;
    EXPECT_EQ(repaired.changes.holes_filled, fills ? 1U : 0U);
    EXPECT_EQ(repaired.changes.triangles_added, fills ? 2U : 0U);
    EXPECT_EQ(repaired.changes.borders_left, fills ? 0U : 1U);
    EXPECT_EQ(topology_of(repaired.mesh).boundary_edges, fills ? 0U : 4U);
    if (fills) {
      EXPECT_DOUBLE_EQ(volume(repaired.mesh), 1.0);
    }
  }
}

TEST(Repair, DoesNotCloseATriangleOntoItself) {
  RepairOptions options;
  options.fill_holes = 100;
  EXPECT_EQ(repair_soundly(test::single_triangle(), options).changes.borders_left, 1U);
}

TEST(Repair, AttributesFollowTheirVertices) {
  // Colours name vertices; a copy has that of its original.
  TriangleMesh mesh = test::bow_tie();
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    mesh.colors.emplace_back(v, 0, 0, 255);
    mesh.normals.emplace_back(0, 0, v % 2 == 0 ? 1 : -1);
  }
  const RepairedMesh repaired = repair_soundly(mesh);
  ASSERT_EQ(repaired.mesh.vertex_count(), 6U);
  ASSERT_EQ(repaired.mesh.colors.size(), 6U);
  ASSERT_EQ(repaired.mesh.normals.size(), 6U);
  for (std::size_t v = 0; v < 6; ++v) {
    const std::size_t source = repaired.mesh.colors[v].x;
    EXPECT_EQ(repaired.mesh.positions[v], mesh.positions[source]);
    EXPECT_EQ(repaired.mesh.normals[v], mesh.normals[source]);
  }
}

// A cube whose sides are charts of their own, two of them of another material and one turned over, with a hole: what
// stays has its wedges, and the triangle that fills the hole those of the vertices.
TEST(Repair, SeamsAndMaterialsStay) {
  TriangleMesh soup;
  const TriangleMesh whole = cube();
  for (std::size_t t = 0; t < 12; ++t) {
    const auto first = static_cast<VertexId>(3 * t);
    for (int k = 0; k < 3; ++k) {
      soup.positions.push_back(whole.positions[whole.triangles[t][k]]);
      soup.texture_coordinates.emplace_back(static_cast<float>(t / 2), static_cast<float>(whole.triangles[t][k]));
    }
    soup.triangles.emplace_back(first, first + 1, first + 2);
    soup.triangle_materials.push_back(t < 4 ? 1 : 0);
  }
  soup.materials.resize(2);
  soup.textures.resize(1);
  turn(soup.triangles[5]);
  const TriangleMesh mesh = clean(soup, {}, "cube").mesh;
  ASSERT_EQ(mesh.wedge_count(), 24U);
  const RepairedMesh repaired = repair_mesh(mesh);
  EXPECT_EQ(test::wedge_problem(repaired.mesh), "");
  EXPECT_EQ(repaired.changes.triangles_turned, 1U);
  EXPECT_EQ(sorted_corners(repaired.mesh), sorted_corners(mesh));
  EXPECT_EQ(repaired.mesh.materials.size(), 2U);
  EXPECT_EQ(repaired.mesh.textures.size(), 1U);

  soup.triangles.erase(soup.triangles.begin() + 3);
  soup.triangle_materials.erase(soup.triangle_materials.begin() + 3);
  RepairOptions options;
  options.fill_holes = 3;
  const RepairedMesh filled = repair_mesh(clean(soup, {}, "cube").mesh, options);
  EXPECT_EQ(test::wedge_problem(filled.mesh), "");
  EXPECT_EQ(filled.changes.triangles_added, 1U);
  EXPECT_EQ(filled.mesh.triangle_count(), 12U);
}

TEST(Repair, WhatProgressThrowsEndsIt) {
  RepairOptions options;
  options.progress = [](const std::string&, std::optional<double>) { throw std::domain_error("stop"); };
  EXPECT_THROW((void)repair_mesh(cube(), options), std::domain_error);
}

}  // namespace
}  // namespace occlod::repair
