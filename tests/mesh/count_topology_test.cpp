#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include "occlod/mesh.h"
#include "support/meshes.h"

namespace occlod {
namespace {

MeshReport count(const TriangleMesh& mesh) {
  MeshReport report;
  count_topology(mesh, report);
  return report;
}

void expect_no_defects(const MeshReport& r) {
  EXPECT_EQ(r.zero_area_triangles, 0u);
  EXPECT_EQ(r.repeated_triangles, 0u);
  EXPECT_EQ(r.nonmanifold_edges, 0u);
  EXPECT_EQ(r.inconsistent_edges, 0u);
  EXPECT_EQ(r.nonmanifold_vertices, 0u);
}

TEST(CountTopology, ClosedSurfacesHaveNoDefects) {
  for (const TriangleMesh& mesh : {test::tetrahedron(), test::octahedron_sphere(3), test::noisy_sphere(2, 7),
                                   test::torus(3, 3), test::torus(6, 5)}) {
    const MeshReport r = count(mesh);
    expect_no_defects(r);
    EXPECT_EQ(r.boundary_edges, 0u);
    EXPECT_EQ(r.components, 1u);
  }
}

TEST(CountTopology, BoundariesAreTheRims) {
  const MeshReport grid = count(test::grid(4, 3));
  expect_no_defects(grid);
  EXPECT_EQ(grid.boundary_edges, 14u);  // 2 * (4 + 3)
  const MeshReport fan = count(test::fan(9));
  expect_no_defects(fan);
  EXPECT_EQ(fan.boundary_edges, 9u);
  EXPECT_EQ(count(test::single_triangle()).boundary_edges, 3u);
}

// Round vertex 0 the rim is a closed walk 1-2-3-1-4-5-1 that meets vertex 1 twice: four triangles share the edge 0-1,
// which holds all of them together at both of its ends.
TEST(CountTopology, ARimThatMeetsAVertexTwiceIsNoFan) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 1}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 4}, {0, 4, 5}, {0, 5, 1}};
  for (int turn = 0; turn < 6; ++turn) {  // whichever triangle comes first
    std::rotate(mesh.triangles.begin(), mesh.triangles.begin() + 1, mesh.triangles.end());
    const MeshReport r = count(mesh);
    EXPECT_EQ(r.nonmanifold_edges, 1u);
    EXPECT_EQ(r.boundary_edges, 6u);
    EXPECT_EQ(r.inconsistent_edges, 0u);
    EXPECT_EQ(r.nonmanifold_vertices, 0u);
  }
}

// Large enough to be counted in parts, with neighbours scattered over all of them. The repeated triangle lies inside:
// each of its three edges then has three triangles.
TEST(CountTopology, PartsOfALargeMeshAddUp) {
  constexpr int side = 300;
  TriangleMesh mesh = test::grid(side, side);
  const auto vertices = static_cast<VertexId>(mesh.vertex_count());
  constexpr VertexId stride = 48'271;  // a prime that does not divide 301 * 301: a permutation
  std::vector<glm::vec3> positions(vertices);
  for (VertexId v = 0; v < vertices; ++v) positions[std::uint64_t{v} * stride % vertices] = mesh.positions[v];
  mesh.positions = positions;
  for (Triangle& t : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      t[corner] = static_cast<VertexId>(std::uint64_t{t[corner]} * stride % vertices);
    }
  }
  const Triangle inside = mesh.triangles[mesh.triangle_count() / 2 + side];
  mesh.triangles.emplace_back(inside.y, inside.z, inside.x);
  const MeshReport r = count(mesh);
  EXPECT_EQ(r.boundary_edges, 4u * side);
  EXPECT_EQ(r.components, 1u);
  EXPECT_EQ(r.repeated_triangles, 1u);
  EXPECT_EQ(r.nonmanifold_edges, 3u);
  EXPECT_EQ(r.nonmanifold_vertices, 0u);
  EXPECT_EQ(r.zero_area_triangles, 0u);
}

// A one-sided strip cannot be oriented: at least one edge is run through twice in one direction, and a strip whose
// cells are wound alike up to the seam has exactly that one. Its single rim has 2 n edges.
TEST(CountTopology, MoebiusStripHasOneInconsistentSeam) {
  for (const int n : {3, 4, 11}) {
    const MeshReport r = count(test::moebius(n));
    EXPECT_EQ(r.inconsistent_edges, 1u);
    EXPECT_EQ(r.boundary_edges, static_cast<std::uint64_t>(2 * n));
    EXPECT_EQ(r.nonmanifold_edges, 0u);
    EXPECT_EQ(r.nonmanifold_vertices, 0u);
  }
}

TEST(CountTopology, ABowTieIsOneComponentWithTwoFans) {
  const MeshReport r = count(test::bow_tie());
  EXPECT_EQ(r.nonmanifold_vertices, 1u);
  EXPECT_EQ(r.nonmanifold_edges, 0u);
  EXPECT_EQ(r.boundary_edges, 6u);
  EXPECT_EQ(r.components, 1u);
}

// Two pages share the spine in the same direction: inconsistent, still manifold. From three on the spine is not
// manifold.
TEST(CountTopology, ABookIsNonManifoldFromTheThirdPage) {
  EXPECT_EQ(count(test::book(2)).inconsistent_edges, 1u);
  EXPECT_EQ(count(test::book(2)).nonmanifold_edges, 0u);
  const MeshReport r = count(test::book(3));
  EXPECT_EQ(r.inconsistent_edges, 0u);
  EXPECT_EQ(r.nonmanifold_edges, 1u);
  EXPECT_EQ(r.boundary_edges, 6u);        // two free edges a page
  EXPECT_EQ(r.nonmanifold_vertices, 0u);  // the spine joins all pages into one fan
}

TEST(CountTopology, BackToBackTrianglesAreRepeated) {
  const MeshReport r = count(test::double_sided_quad());
  EXPECT_EQ(r.repeated_triangles, 2u);
  EXPECT_EQ(r.nonmanifold_edges, 1u);  // the diagonal has four
  EXPECT_EQ(r.boundary_edges, 0u);
  EXPECT_EQ(r.inconsistent_edges, 0u);
}

TEST(CountTopology, ComponentsAreCounted) {
  EXPECT_EQ(count(test::two_components()).components, 2u);
  EXPECT_EQ(count(test::many_tetrahedra(17)).components, 17u);
  TriangleMesh with_loose_vertex = test::tetrahedron();
  with_loose_vertex.positions.emplace_back(9.0f);
  EXPECT_EQ(count(with_loose_vertex).components, 1u);  // a vertex without triangles is no component
}

TEST(CountTopology, ZeroAreaMeansExactlyOnALine) {
  TriangleMesh mesh;
  // p / 2, p and 2 p lie on one line exactly; one unit in the last place beside it they do not.
  const glm::vec3 p(0.2f, 0.4f, 0.6f);
  mesh.positions = {p * 0.5f, p, p * 2.0f, p * 2.0f};
  mesh.positions[3].z = std::nextafter(mesh.positions[3].z, 9.0f);
  mesh.triangles = {{0, 1, 2}};
  EXPECT_EQ(count(mesh).zero_area_triangles, 1u);
  mesh.triangles = {{0, 1, 3}};
  EXPECT_EQ(count(mesh).zero_area_triangles, 0u);
}

// A second, plain count with maps over a random soup, where every kind of edge occurs.
TEST(CountTopology, AgreesWithAPlainCountOnRandomSoups) {
  std::mt19937 random(5);
  for (int round = 0; round < 20; ++round) {
    TriangleMesh mesh;
    for (int v = 0; v < 12; ++v) mesh.positions.emplace_back(v, v * v, v * v * v);  // never three on a line
    while (mesh.triangles.size() < 25) {
      const Triangle t(random() % 12, random() % 12, random() % 12);
      if (t.x != t.y && t.y != t.z && t.z != t.x) mesh.triangles.push_back(t);
    }
    std::map<std::array<VertexId, 2>, std::array<int, 2>> uses;  // of an edge, in either direction
    std::map<std::array<VertexId, 3>, int> corners;
    for (const Triangle& t : mesh.triangles) {
      for (int i = 0; i < 3; ++i) {
        const VertexId a = t[i];
        const VertexId b = t[(i + 1) % 3];
        ++uses[{std::min(a, b), std::max(a, b)}][a < b ? 0 : 1];
      }
      std::array<VertexId, 3> sorted{t.x, t.y, t.z};
      std::sort(sorted.begin(), sorted.end());
      ++corners[sorted];
    }
    MeshReport expected;
    for (const auto& [edge, n] : uses) {
      expected.boundary_edges += n[0] + n[1] == 1;
      expected.nonmanifold_edges += n[0] + n[1] > 2;
      expected.inconsistent_edges += n == std::array<int, 2>{2, 0} || n == std::array<int, 2>{0, 2};
    }
    const MeshReport r = count(mesh);
    EXPECT_EQ(r.boundary_edges, expected.boundary_edges);
    EXPECT_EQ(r.nonmanifold_edges, expected.nonmanifold_edges);
    EXPECT_EQ(r.inconsistent_edges, expected.inconsistent_edges);
    EXPECT_EQ(r.repeated_triangles, 25u - corners.size());
  }
}

}  // namespace
}  // namespace occlod
