#include "measure/surface_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>

#include "measure/triangle_distance.h"
#include "support/meshes.h"

namespace occlod::measure {
namespace {

SurfaceDistance between(const TriangleMesh& a, const TriangleMesh& b, const SampleOptions& options = {20'000, 1}) {
  return surface_distance(Surface(a.positions, a.triangles), Surface(b.positions, b.triangles), options);
}

TriangleMesh scaled(TriangleMesh mesh, float factor) {
  for (glm::vec3& p : mesh.positions) p *= factor;
  return mesh;
}

TriangleMesh moved(TriangleMesh mesh, const glm::vec3& by) {
  for (glm::vec3& p : mesh.positions) p += by;
  return mesh;
}

TEST(SurfaceDistance, OfAMeshFromItselfIsRounding) {
  const TriangleMesh mesh = test::noisy_sphere(4, 1);
  const SurfaceDistance distance = between(mesh, mesh);
  EXPECT_LT(distance.farther().max, 1e-14);
  EXPECT_LT(distance.rms(), 1e-14);
}

// Every point of one square is 0.25 from the other, also at the corners: all four numbers are 0.25.
TEST(SurfaceDistance, OfParallelSquaresIsTheirGap) {
  const SurfaceDistance distance = between(test::grid(3, 2), moved(test::grid(5, 5), {0.0F, 0.0F, 0.25F}));
  for (const OneWayDistance& way : {distance.a_to_b, distance.b_to_a}) {
    EXPECT_NEAR(way.rms, 0.25, 1e-12);
    EXPECT_NEAR(way.max, 0.25, 1e-12);
  }
}

// A = the unit square, B = the same and another beside it, 0 <= x <= 2: A lies in B; from a point of B with x > 1 it is
// x - 1 to A. Mean square over B: half of the area times the mean of t^2 over [0, 1] = 1/2 * 1/3. The farthest are the
// vertices with x = 2. A maximum over samples alone would be less than 1.
TEST(SurfaceDistance, WaysDiffer) {
  TriangleMesh wide = test::grid(4, 4);
  test::append(wide, test::grid(4, 4), {1.0F, 0.0F, 0.0F});
  const SurfaceDistance distance = between(test::grid(1, 1), wide);
  EXPECT_LT(distance.a_to_b.max, 1e-14);
  EXPECT_EQ(distance.b_to_a.max, 1.0);
  EXPECT_EQ(distance.b_to_a.max_at.x, 2.0);
  EXPECT_NEAR(distance.b_to_a.rms, std::sqrt(1.0 / 6.0), 1e-4);
  EXPECT_EQ(distance.rms(), distance.b_to_a.rms);
  EXPECT_EQ(&distance.farther(), &distance.b_to_a);
  const SurfaceDistance swapped = between(wide, test::grid(1, 1));
  EXPECT_EQ(&swapped.farther(), &swapped.a_to_b);
}

// How far the planes of the triangles are from the origin, at least.
double inner_radius(const TriangleMesh& mesh) {
  double radius = 1.0;
  for (const Triangle& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    radius = std::min(radius, std::abs(glm::dot(a, glm::normalize(glm::cross(b - a, c - a)))));
  }
  return radius;
}

// A polyhedron P between the balls of radius r and 1, and 1.1 P. The point 1.1 p is 0.1 |p| <= 0.1 from p, and at least
// 1.1 r - 1 from the unit ball; at a vertex, |p| = 1, both bounds are 0.1. The same holds the other way.
TEST(SurfaceDistance, OfASphereAndALargerOne) {
  const TriangleMesh sphere = test::octahedron_sphere(4);
  const double least = 1.1 * inner_radius(sphere) - 1.0;
  ASSERT_GT(least, 0.08);
  const SurfaceDistance distance = between(scaled(sphere, 1.1F), sphere);
  EXPECT_NEAR(distance.a_to_b.max, 0.1, 1e-6);
  EXPECT_NEAR(glm::length(distance.a_to_b.max_at), 1.1, 1e-6);
  for (const OneWayDistance& way : {distance.a_to_b, distance.b_to_a}) {
    EXPECT_GT(way.rms, least);
    EXPECT_LT(way.rms, 0.1);
  }
}

// Samples follow the area, not the number of triangles: 2 triangles in z = 0 beside 2,000 in a tenth of their area at
// z = 1, measured to the plane z = 0.
TEST(SurfaceDistance, SamplesFollowArea) {
  TriangleMesh mesh = scaled(test::grid(1, 1), 10.0F);                                           // area 100
  TriangleMesh patch = moved(scaled(test::grid(50, 20), std::sqrt(10.0F)), {0.0F, 0.0F, 1.0F});  // area 10
  test::append(mesh, patch, {0.0F, 0.0F, 0.0F});
  const SurfaceDistance distance = between(mesh, scaled(test::grid(1, 1), 10.0F));
  EXPECT_NEAR(distance.a_to_b.rms * distance.a_to_b.rms, 10.0 / 110.0, 1e-3);
}

TEST(SurfaceDistance, SameSeedSameNumbers) {
  const TriangleMesh a = test::noisy_sphere(3, 1), b = test::noisy_sphere(3, 2);
  const SurfaceDistance first = between(a, b, {1000, 7}), again = between(a, b, {1000, 7}),
                        other = between(a, b, {1000, 8});
  EXPECT_EQ(first.a_to_b.rms, again.a_to_b.rms);
  EXPECT_EQ(first.b_to_a.max_at, again.b_to_a.max_at);
  EXPECT_NE(first.a_to_b.rms, other.a_to_b.rms);
}

// Vertices that no triangle uses are no part of the surface.
TEST(SurfaceDistance, UnusedVerticesDoNotCount) {
  TriangleMesh mesh = test::grid(2, 2);
  mesh.positions.emplace_back(100.0F, 0.0F, 0.0F);
  const Surface surface(mesh.positions, mesh.triangles);
  EXPECT_NEAR(surface.diagonal(), std::sqrt(2.0), 1e-12);
  EXPECT_LT(between(mesh, test::grid(2, 2)).a_to_b.max, 1e-14);
}

// Triangles without area are the lines that they cover. A: the segment from (0,0,0) to (1,0,0), twice; B: one at y = 3.
TEST(SurfaceDistance, OfTrianglesWithoutArea) {
  TriangleMesh line;
  line.positions = {{0, 0, 0}, {0.25F, 0, 0}, {1, 0, 0}};
  line.triangles = {{0, 1, 2}, {2, 1, 0}};
  const SurfaceDistance distance = between(line, moved(line, {0.0F, 3.0F, 0.0F}), {100, 1});
  for (const OneWayDistance& way : {distance.a_to_b, distance.b_to_a}) {
    EXPECT_NEAR(way.rms, 3.0, 1e-12);
    EXPECT_NEAR(way.max, 3.0, 1e-12);
  }
  // Beside triangles with area they take no samples, but their vertices count for the maximum, and they can be nearest.
  TriangleMesh mixed = moved(test::grid(2, 2), {0.0F, 10.0F, 0.0F});
  test::append(mixed, line, {0.0F, 0.0F, 0.0F});
  const Surface surface(mixed.positions, mixed.triangles);
  EXPECT_EQ(surface.distance_to({0.5, 0.0, 2.0}), 2.0);
  const OneWayDistance to_grid = between(mixed, moved(test::grid(2, 2), {0.0F, 10.0F, 0.0F})).a_to_b;
  EXPECT_LT(to_grid.rms, 1e-12);
  EXPECT_EQ(to_grid.max, 10.0);
}

// By brute force over barycentric coordinates: no point of the triangle is nearer than the one found by more than
// rounding, and the one found lies on the triangle. Triangles from healthy to needles of 1e-9.
TEST(NearestPoint, IsNearest) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto any = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  for (const double thinness : {1.0, 1e-3, 1e-6, 1e-9, 0.0}) {
    for (int i = 0; i < 200; ++i) {
      const glm::dvec3 a = any(), b = any(), c = glm::mix(a, b, 0.3) + thinness * any(), p = 2.0 * any();
      const glm::dvec3 q = nearest_point(p, a, b, c);
      const double found = glm::distance(p, q);
      double nearest = found, off = 1.0;
      constexpr int steps = 40;
      for (int v = 0; v <= steps; ++v) {
        for (int w = 0; v + w <= steps; ++w) {
          const glm::dvec3 on = a + (b - a) * (1.0 * v / steps) + (c - a) * (1.0 * w / steps);
          nearest = std::min(nearest, glm::distance(p, on));
          off = std::min(off, glm::distance(q, on));
        }
      }
      EXPECT_LE(found, nearest + 1e-12) << thinness;
      // Corners and sides of the grid's cells are at most 4 / 40 apart.
      EXPECT_LE(off, 4.0 / steps) << thinness;
    }
  }
}

TEST(NearestPoint, CornersAreExact) {
  const glm::dvec3 a(0.1, 0.2, 0.3), b(1e6, 0.7, -3.0), c(-2.0, 1e-7, 5.0);
  for (const glm::dvec3& corner : {a, b, c}) EXPECT_EQ(nearest_point(corner, a, b, c), corner);
}

}  // namespace
}  // namespace occlod::measure
