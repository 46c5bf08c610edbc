// Shapes and topologies that break simplifiers. Each builds, down to nothing, and what its cuts must be can be told
// beforehand.
#include "hierarchy/hard_geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "occlod/mesh.h"
#include "splits/star.h"
#include "support/meshes.h"

namespace occlod {
namespace {

using test::build_soundly;

TriangleMesh cleaned(const TriangleMesh& mesh) { return clean(mesh, {}, "test mesh").mesh; }

MeshReport topology_of(const TriangleMesh& mesh) {
  MeshReport report;
  count_topology(mesh, report);
  return report;
}

TriangleMesh cut_to(const Hierarchy& hierarchy, std::size_t triangles) {
  return cut_mesh(hierarchy, cut_to_triangles(hierarchy, triangles));
}

// The surface of the unit cube, n x n cells a side.
TriangleMesh box(int n) {
  TriangleMesh mesh;
  const TriangleMesh side = test::grid(n, n);
  for (int axis = 0; axis < 3; ++axis) {
    for (const float height : {0.0F, 1.0F}) {
      TriangleMesh turned = side;
      for (glm::vec3& p : turned.positions) {
        glm::vec3 q;
        q[axis] = height, q[(axis + 1) % 3] = p.x, q[(axis + 2) % 3] = p.y;
        p = q;
      }
      if (height == 0.0F)
        for (Triangle& t : turned.triangles) std::swap(t.y, t.z);
      test::append(mesh, turned, {});
    }
  }
  return cleaned(mesh);
}

// A plate of 10 n x 10 n cells with n x n square holes; closed: with a second face below and walls between.
TriangleMesh plate(int n, bool closed) {
  TriangleMesh mesh;
  const auto is_there = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < 10 * n && y < 10 * n && (x % 10 < 3 || x % 10 > 6 || y % 10 < 3 || y % 10 > 6);
  };
  const auto add = [&](const std::array<glm::vec3, 4>& p) {
    const auto first = static_cast<VertexId>(mesh.vertex_count());
    mesh.positions.insert(mesh.positions.end(), p.begin(), p.end());
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.triangles.emplace_back(first, first + 2, first + 3);
  };
  for (int y = 0; y < 10 * n; ++y)
    for (int x = 0; x < 10 * n; ++x) {
      if (!is_there(x, y)) continue;
      const auto corner = [&](int i, int j, int z) { return glm::vec3(x + i, y + j, z); };
      add({corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)});
      if (!closed) continue;
      add({corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0), corner(1, 0, 0)});
      if (!is_there(x - 1, y)) add({corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0)});
      if (!is_there(x + 1, y)) add({corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1)});
      if (!is_there(x, y - 1)) add({corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)});
      if (!is_there(x, y + 1)) add({corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0)});
    }
  return cleaned(mesh);
}

TEST(HardGeometry, TrianglesWithoutAreaBetweenOthers) {
  // Every triangle of a sheet gets a vertex in the middle of its first side, and one without area that closes the gap
  // to the neighbour. There are no cracks in any cut, as there are none in the input.
  TriangleMesh mesh = test::grid(16, 16);
  const std::size_t triangles = mesh.triangle_count();
  for (std::size_t t = 0; t < triangles; ++t) {
    const Triangle old = mesh.triangles[t];
    const auto middle = static_cast<VertexId>(mesh.vertex_count());
    mesh.positions.push_back(0.5F * (mesh.positions[old.x] + mesh.positions[old.y]));
    mesh.triangles[t] = {middle, old.y, old.z};
    mesh.triangles.emplace_back(old.x, middle, old.z);
    mesh.triangles.emplace_back(old.x, old.y, middle);
  }
  for (std::size_t v = 0, n = mesh.vertex_count(); v < n; v += 3) mesh.positions[v].z = 0.0F;
  const MeshReport report = topology_of(mesh);
  ASSERT_EQ(report.zero_area_triangles, triangles);
  (void)build_soundly(mesh);
}

TEST(HardGeometry, AllTrianglesOnOneLine) {
  // No triangle has an area, so no plane has a weight: nothing but lengths orders the collapses. The coordinates are
  // sums of halves, so that the points lie on the line exactly.
  TriangleMesh mesh;
  for (int i = 0; i < 1002; ++i) {
    const float t = 0.5F * static_cast<float>(i);
    mesh.positions.emplace_back(t, 2.0F * t, 3.0F * t);
    if (i >= 2) mesh.triangles.emplace_back(i - 2, i - 1, i);
  }
  ASSERT_EQ(topology_of(mesh).zero_area_triangles, mesh.triangle_count());
  (void)build_soundly(mesh);
}

TEST(HardGeometry, Needles) {
  // A sheet whose every other column is 1e-6 wide: a million times as long as wide.
  TriangleMesh mesh = test::grid(40, 20);
  for (glm::vec3& p : mesh.positions) {
    const int column = static_cast<int>(std::lround(p.x * 40.0F));
    p.x = static_cast<float>(column / 2) + (column % 2 == 0 ? 0.0F : 1e-6F);
    p.y *= 20.0F;
  }
  (void)build_soundly(cleaned(mesh));
}

TEST(HardGeometry, BoxIsExactDownToTwelveTriangles) {
  // Quadrics of flat regions are singular, those along edges nearly. A box needs its eight corners and 12 triangles;
  // every cut that has them is the box itself, so no collapse before costs anything.
  const TriangleMesh mesh = box(24);
  const Hierarchy hierarchy = build_soundly(mesh, 12);
  EXPECT_EQ(hierarchy.base_triangle_count(), 12U);
  EXPECT_EQ(hierarchy.base_vertex_count(), 8U);
  for (std::size_t v = 0; v < 8; ++v)
    for (int axis = 0; axis < 3; ++axis) {
      const float coordinate = hierarchy.positions()[v][axis];
      EXPECT_TRUE(coordinate == 0.0F || coordinate == 1.0F);
    }
  EXPECT_LT(hierarchy.error_bound(), 1e-4F);  // what rounding upwards adds
}

TEST(HardGeometry, RepeatedAndOppositeTriangles) {
  // Each triangle of a sphere again in the same and once in the other direction. All are there at full refinement.
  TriangleMesh mesh = test::octahedron_sphere(3);
  for (std::size_t t = 0, n = mesh.triangle_count(); t < n; ++t) {
    const Triangle old = mesh.triangles[t];
    mesh.triangles.emplace_back(old.y, old.z, old.x);
    mesh.triangles.emplace_back(old.y, old.x, old.z);
  }
  ASSERT_EQ(topology_of(mesh).repeated_triangles, 2 * mesh.triangle_count() / 3);
  (void)build_soundly(mesh);
}

TEST(HardGeometry, SheetsThatLieThereTwiceSimplifyAsOne) {
  TriangleMesh single = test::grid(60, 60);
  for (glm::vec3& p : single.positions) p.z = 0.05F * std::sin(3.0F * p.x) * std::cos(4.0F * p.y);
  const Hierarchy alone = build_soundly(single, 64);
  const auto error_alone = static_cast<double>(cut_to_triangles(alone, 200).error);
  for (const std::size_t n : {std::size_t{1}, std::size_t{20}})  // all triangles are doubled, or one in twenty
    for (const bool turned : {false, true}) {
      TriangleMesh mesh = single;
      for (std::size_t i = 0; i < single.triangle_count(); i += n) {
        const Triangle& t = single.triangles[i];
        mesh.triangles.push_back(turned ? Triangle(t.y, t.x, t.z) : t);
      }
      const Hierarchy hierarchy = build_soundly(mesh, 64);
      const FixedCut cut = cut_to_triangles(hierarchy, n == 1 ? 400 : 210);
      EXPECT_LE(static_cast<double>(cut.error), 1.5 * error_alone);
      EXPECT_GE(test::area_of(cut_mesh(hierarchy, cut)), 0.99 * test::area_of(n == 1 ? mesh : single));
      EXPECT_LE(cut_mesh(hierarchy, cut_to_error(hierarchy, 0.05)).triangle_count(), 130U);
    }
}

TEST(HardGeometry, SheetsThatTouchAtAPointSimplifyAsIfApart) {
  // Two flat sheets, upright on each other, have one vertex in common, which may move along the line in both.
  TriangleMesh mesh = test::grid(10, 10), upright = test::grid(10, 10);
  for (glm::vec3& p : upright.positions) p = {0.5F + 0.875F * (p.x - 0.5F), 0.5F, p.y - 0.5F};
  test::append(mesh, upright, {});
  mesh = cleaned(mesh);
  ASSERT_EQ(topology_of(mesh).nonmanifold_vertices, 1U);
  const Hierarchy hierarchy = build_soundly(mesh, 8);
  EXPECT_LT(hierarchy.error_bound(), 1e-4F);
}

TEST(HardGeometry, ThreeSheetsAtOneLine) {
  // Flat sheets that meet at a line of edges of three triangles each: two triangles a sheet are exact, and the line is
  // held like a boundary, so that 6 triangles are reached without error.
  TriangleMesh mesh;
  const TriangleMesh sheet = test::grid(12, 12);
  for (const glm::vec3& direction : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(-1, -1, 0)}) {
    TriangleMesh turned = sheet;
    for (glm::vec3& p : turned.positions) p = {p.x * direction.x, p.x * direction.y, p.y};
    test::append(mesh, turned, {});
  }
  mesh = cleaned(mesh);
  ASSERT_EQ(topology_of(mesh).nonmanifold_edges, 12U);
  const Hierarchy hierarchy = build_soundly(mesh, 6);
  EXPECT_EQ(hierarchy.base_triangle_count(), 6U);
  EXPECT_LT(hierarchy.error_bound(), 1e-4F);
  EXPECT_EQ(topology_of(cut_to(hierarchy, 6)).nonmanifold_edges, 1U);
}

TEST(HardGeometry, ChainOfTetrahedraThatTouch) {
  // Every link is a vertex of two fans.
  TriangleMesh mesh;
  for (int i = 0; i < 200; ++i) test::append(mesh, test::tetrahedron(), glm::vec3(static_cast<float>(i), 0, 0));
  mesh = cleaned(mesh);
  ASSERT_EQ(topology_of(mesh).nonmanifold_vertices, 199U);
  (void)build_soundly(mesh);
}

TEST(HardGeometry, KleinBottle) {
  // Closed, of one side: some edges run the same way in both of their triangles. A torus whose tube is glued to itself
  // mirrored.
  const int n = 40, m = 20;
  TriangleMesh mesh = test::torus(n, m);
  for (Triangle& t : mesh.triangles) {
    const auto seam = [&](int i) { return static_cast<int>(t[i]) / m == 0; };
    const bool wraps = std::max({t.x, t.y, t.z}) / m == static_cast<VertexId>(n - 1) && (seam(0) || seam(1) || seam(2));
    for (int i = 0; wraps && i < 3; ++i)
      if (seam(i)) t[i] = (m - t[i]) % m;
  }
  const MeshReport report = topology_of(mesh);
  ASSERT_EQ(report.boundary_edges, 0U);
  ASSERT_EQ(report.nonmanifold_edges, 0U);
  ASSERT_EQ(report.inconsistent_edges, static_cast<std::uint64_t>(m));
  const Hierarchy hierarchy = build_soundly(mesh);
  EXPECT_EQ(test::euler_characteristic(cut_to(hierarchy, 400)), 0);  // that of the bottle, while the topology is kept
}

TEST(HardGeometry, InconsistentWinding) {
  // A sphere of which half of the triangles, at random, are turned. Still one closed surface: V - E + F = 2.
  TriangleMesh mesh = test::noisy_sphere(4, 1);
  std::mt19937 random(5);
  for (Triangle& t : mesh.triangles)
    if (random() % 2 == 0) std::swap(t.y, t.z);
  ASSERT_GT(topology_of(mesh).inconsistent_edges, 1000U);
  (void)build_soundly(mesh);
}

TEST(HardGeometry, FiveThousandTinyComponents) {
  // More components than triangles are allowed: components vanish as a whole, the base keeps to 64.
  TriangleMesh mesh;
  for (int i = 0; i < 5000; ++i)
    test::append(mesh, test::tetrahedron(),
                 glm::vec3(2 * (i % 17), 2 * (i / 17 % 17), 2 * (i / 289)));  // NOLINT(bugprone-integer-division)
  ASSERT_EQ(topology_of(mesh).components, 5000U);
  EXPECT_GT(build_soundly(mesh, 64).base_triangle_count(), 0U);
}

TEST(HardGeometry, UnreferencedVertices) {
  // clean() drops them; whoever does without it gets them back as vertices that no triangle uses.
  TriangleMesh mesh = test::noisy_sphere(2, 1);
  const std::size_t vertices = mesh.vertex_count();
  mesh.positions.insert(mesh.positions.begin(), {100.0F, 0, 0});
  mesh.positions.emplace_back(-50.0F, 3.0F, 1.0F);
  for (Triangle& t : mesh.triangles) t += Triangle(1);
  EXPECT_EQ(build_soundly(cleaned(mesh)).vertex_count(), vertices);
  EXPECT_EQ(build_soundly(mesh).vertex_count(), vertices + 2);
}

TEST(HardGeometry, SheetWithHolesKeepsThem) {
  // 16 holes: V - E + F = 1 - 16, as long as legal collapses are enough, which is far below 1,000 triangles (a hole
  // needs some ten).
  const TriangleMesh mesh = plate(4, false);
  ASSERT_EQ(test::euler_characteristic(mesh), -15);
  const Hierarchy hierarchy = build_soundly(mesh);
  EXPECT_EQ(test::euler_characteristic(cut_to(hierarchy, 1000)), -15);
  EXPECT_LT(cut_to_triangles(hierarchy, 1000).error, 1e-3F);  // all of it is flat
}

TEST(HardGeometry, SurfaceOfGenusSixteenKeepsIt) {
  // V - E + F = 2 - 2 * 16.
  const TriangleMesh mesh = plate(4, true);
  ASSERT_EQ(topology_of(mesh).boundary_edges, 0U);
  ASSERT_EQ(test::euler_characteristic(mesh), -30);
  const TriangleMesh coarse = cut_to(build_soundly(mesh), 1000);
  EXPECT_EQ(test::euler_characteristic(coarse), -30);
  EXPECT_EQ(topology_of(coarse).boundary_edges, 0U);
}

TEST(HardGeometry, FanOfAHundredThousandSpokes) {
  // One vertex with 100,000 neighbours: nothing may take time or memory of the square of that.
  const TriangleMesh mesh = test::fan(100'000);
  const Hierarchy hierarchy = build_soundly(mesh);
  EXPECT_LT(hierarchy.bytes(), 400 * mesh.vertex_count());
}

TEST(HardGeometry, ShortEdgesBesideLongOnes) {
  // Stars of which some corners are 1e-4 apart and others 1e4: bounds and cones are made of differences of both.
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> exponent(-4.0F, 4.0F);
    TriangleMesh mesh = test::octahedron_sphere(2);
    for (glm::vec3& p : mesh.positions) p *= std::pow(10.0F, exponent(random));
    (void)build_soundly(mesh);
  }
}

TEST(HardGeometry, AttributeSeamsDoNotOpen) {
  // A box whose sides have normals and colours of their own: vertices along its edges are there two or three times in
  // the file. Welded, no cut is open along them.
  TriangleMesh mesh;
  const TriangleMesh welded = box(8);
  for (const Triangle& t : welded.triangles) {
    const glm::vec3 p[] = {welded.positions[t.x], welded.positions[t.y], welded.positions[t.z]};
    const glm::vec3 normal = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
    for (const glm::vec3& q : p) {
      mesh.positions.push_back(q);
      mesh.normals.push_back(normal);
      mesh.colors.emplace_back(glm::u8vec4(glm::vec4(127.0F * normal + 128.0F, 255.0F)));
    }
    const auto last = static_cast<VertexId>(mesh.vertex_count());
    mesh.triangles.emplace_back(last - 3, last - 2, last - 1);
  }
  const CleanMesh seamless = clean(mesh, {}, "box");
  EXPECT_EQ(seamless.mesh.vertex_count(), welded.vertex_count());
  EXPECT_EQ(seamless.report.seam_vertices, 8U + 12U * 7U);  // corners, and vertices along edges
  const Hierarchy hierarchy = build_soundly(seamless.mesh, 12);
  EXPECT_EQ(topology_of(cut_to(hierarchy, 100)).boundary_edges, 0U);
  // Corners have three wedges, other vertices along edges two.
  EXPECT_EQ(hierarchy.vertex_count(), welded.vertex_count());
  EXPECT_EQ(hierarchy.data().normals.size(), welded.vertex_count() + 8 * 2 + 12 * 7);
}

TEST(HardGeometry, ConesOfObliquePlanesHoldTheirNormals) {
  // All normals are one, up to the rounding of positions, and so is the cosine of the cone in single precision. In
  // double precision they are not exactly the axis. (Fails without cone_slack and normal_slack; either is enough here.)
  std::mt19937 random(6);
  std::normal_distribution<float> normal;
  for (int tries = 0; tries < 20; ++tries) {
    const glm::vec3 x(normal(random), normal(random), normal(random)), y(normal(random), normal(random), 0.0F);
    TriangleMesh mesh = test::grid(12, 12);
    for (glm::vec3& p : mesh.positions) p = p.x * x + p.y * y;
    const Hierarchy hierarchy = build_hierarchy(mesh);
    for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
      const NormalCone cone = hierarchy.node(s).cone();
      star_of(hierarchy, s).for_each_inserted([&](const Triangle& t) {
        const glm::dvec3 a(hierarchy.positions()[t.x]), b(hierarchy.positions()[t.y]), c(hierarchy.positions()[t.z]);
        const glm::dvec3 n = glm::normalize(glm::cross(b - a, c - a));
        EXPECT_GE(glm::dot(n, glm::dvec3(cone.axis)), static_cast<double>(cone.cos_angle));
      });
    }
  }
}

}  // namespace
}  // namespace occlod
