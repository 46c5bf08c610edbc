#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "occlod/base.h"
#include "occlod/mesh.h"
#include "support/meshes.h"

namespace occlod {
namespace {

// The unit square as two triangles that share no vertex: 0-1-2 and 3-4-5, with 3 = 0 and 4 = 2 in position.
TriangleMesh split_square() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  return mesh;
}

TEST(Clean, KeepsACleanMeshAsItIs) {
  const TriangleMesh mesh = test::torus(5, 4);
  const CleanMesh result = clean(mesh, {}, "torus");
  EXPECT_EQ(result.mesh.positions, mesh.positions);
  EXPECT_EQ(result.mesh.triangles, mesh.triangles);
  EXPECT_EQ(result.report.vertices_welded, 0u);
  EXPECT_EQ(result.report.vertices_read, 20u);   // 5 * 4, filled in from the mesh
  EXPECT_EQ(result.report.triangles_read, 40u);  // 2 * 5 * 4
}

TEST(Clean, WeldsOntoTheFirstVertexAtAPosition) {
  const CleanMesh result = clean(split_square(), {}, "square");
  const std::vector<glm::vec3> expected = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_EQ(result.mesh.positions, expected);
  // 3 -> 0, 4 -> 2, and 5 moves up behind the three that stay.
  EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(result.report.vertices_welded, 2u);
  EXPECT_EQ(result.report.boundary_edges, 4u);
}

TEST(Clean, WeldsNegativeZeroOntoZeroAndNothingElse) {
  TriangleMesh mesh = split_square();
  mesh.positions[3] = {-0.0f, 0.0f, -0.0f};
  mesh.positions[4].x = std::nextafter(1.0f, 2.0f);  // the nearest other float stays apart
  EXPECT_EQ(clean(mesh, {}, "square").report.vertices_welded, 1u);
}

TEST(Clean, ComputesUnusableNormalsFromTheTriangles) {
  TriangleMesh mesh = test::grid(1, 1);  // faces +z
  mesh.normals = {{0, 0, 0}, {std::numeric_limits<float>::quiet_NaN(), 0, 0}, {0, 3, 0}, {0, 0, -1}};
  const CleanMesh result = clean(mesh, {}, "grid");
  const std::vector<glm::vec3> expected = {{0, 0, 1}, {0, 0, 1}, {0, 1, 0}, {0, 0, -1}};
  EXPECT_EQ(result.mesh.normals, expected);
}

TEST(Clean, DropsAndCountsTrianglesThatWeldingDegenerates) {
  TriangleMesh mesh = split_square();
  mesh.positions.emplace_back(1, 1, 0);  // 6 = 2 in position
  mesh.positions.emplace_back(9, 9, 9);  // 7, used only by the triangle that goes
  mesh.triangles.emplace_back(2, 6, 7);  // two corners at (1, 1, 0)
  const CleanMesh result = clean(mesh, {}, "square");
  EXPECT_EQ(result.report.repeated_index_triangles, 1u);
  EXPECT_EQ(result.report.unreferenced_vertices, 1u);  // 7
  EXPECT_EQ(result.report.vertices_welded, 3u);
  EXPECT_EQ(result.mesh.vertex_count(), 4u);
  EXPECT_EQ(result.mesh.triangle_count(), 2u);
}

// As STL has it, with a vertex for each corner: what is welded is exactly what was taken apart, and leaders are
// numbered in the order in which corners first name them.
TEST(Clean, WeldsASoupBackIntoTheSurface) {
  const TriangleMesh surface = test::noisy_sphere(5, 1);
  TriangleMesh soup;
  for (const Triangle& t : surface.triangles) {
    const auto first = static_cast<VertexId>(soup.vertex_count());
    for (int corner = 0; corner < 3; ++corner) soup.positions.push_back(surface.positions[t[corner]]);
    soup.triangles.emplace_back(first, first + 1, first + 2);
  }
  const CleanMesh result = clean(soup, {}, "soup");
  EXPECT_EQ(result.mesh.vertex_count(), surface.vertex_count());
  EXPECT_EQ(result.report.vertices_welded, soup.vertex_count() - surface.vertex_count());
  EXPECT_EQ(result.report.boundary_edges, 0u);
  VertexId seen = 0;
  for (std::size_t t = 0; t < surface.triangle_count(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const VertexId v = result.mesh.triangles[t][corner];
      ASSERT_LE(v, seen);
      seen += v == seen;
      ASSERT_EQ(result.mesh.positions[v], surface.positions[surface.triangles[t][corner]]);
    }
  }
}

// Every vertex that was read is kept, welded away or dropped for one counted reason.
TEST(Clean, AccountsForEveryVertex) {
  TriangleMesh mesh = split_square();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  mesh.positions.insert(mesh.positions.begin() + 6, {{1, 1, 0}, {9, 9, 9}, {nan, 0, 0}, {5, 5, 5}, {0, 0, 0}});
  mesh.triangles.emplace_back(2, 6, 7);
  const CleanMesh result = clean(mesh, {}, "square");
  const MeshReport& r = result.report;
  EXPECT_EQ(r.nonfinite_vertices, 1u);
  EXPECT_EQ(r.unreferenced_vertices, 3u);  // 7, whose triangle went; 9; and 10, though it lies on a used position
  EXPECT_EQ(r.vertices_read - r.vertices_welded - r.unreferenced_vertices - r.nonfinite_vertices,
            result.mesh.vertex_count());
}

TEST(Clean, RefusesWhatCannotBeAMesh) {
  TriangleMesh far = test::tetrahedron();
  far.triangles[2].y = 4;
  TriangleMesh too_far = test::tetrahedron();
  too_far.positions[2].z = -1.6e37F;
  TriangleMesh infinite = test::tetrahedron();
  infinite.positions[3].y = -std::numeric_limits<float>::infinity();
  TriangleMesh collapsed = test::single_triangle();
  collapsed.triangles[0] = {1, 1, 2};
  const auto place_of = [](const TriangleMesh& mesh) {
    try {
      static_cast<void>(clean(mesh, {}, "it.ply"));
    } catch (const Error& error) {
      EXPECT_EQ(error.diagnosis().subject, "it.ply");
      EXPECT_FALSE(error.diagnosis().remedy.empty());
      return "at " + error.diagnosis().place;
    }
    return std::string("accepted");
  };
  EXPECT_EQ(place_of(far), "at triangle 2");
  EXPECT_EQ(place_of(infinite), "at vertex 3, numbered from 0");
  EXPECT_EQ(place_of(too_far), "at vertex 2, numbered from 0");
  EXPECT_EQ(place_of(collapsed), "at ");
  EXPECT_EQ(place_of({}), "at ");
}

}  // namespace
}  // namespace occlod
