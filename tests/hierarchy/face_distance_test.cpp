// The parts that measure guaranteed errors, on shapes whose distances are known.
#include "splits/face_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "support/meshes.h"

namespace occlod {
namespace {

// A sequence without collapses: the input is the base.
CollapseSequence without_collapses(const TriangleMesh& mesh) {
  CollapseSequence sequence;
  for (const Triangle& t : mesh.triangles) sequence.base.push_back({t, no_id});
  return sequence;
}

// The distance bound of a triangle between three vertices of the mesh.
float bound_of(const TriangleMesh& mesh, const Triangle& corners, float wanted, float useful) {
  const CollapseSequence sequence = without_collapses(mesh);
  const ReferenceMesh reference(mesh.positions, LevelFaces(sequence), 0, {});
  FaceDistance distance(reference);
  return distance.bound(
      {reference.vertex_of(corners.x), reference.vertex_of(corners.y), reference.vertex_of(corners.z)}, wanted, useful);
}

// Half of the unit square, over a flat grid: it lies on it, however its cells are cut by the triangle's edges.
TEST(FaceDistance, FindsAPlaneItLiesOn) {
  const TriangleMesh mesh = test::grid(5, 4);
  EXPECT_LE(bound_of(mesh, {0, 5, 29}, 0.02F, 1.0F), 0.02F);
}

// The same over a grid of cells 1/8 wide with one vertex pulled down by 0.3. Where it was the pit is nearest below the
// two faces whose rim is a diagonal, 0.0884 away: 0.3 * 0.0884 / hypot(0.3, 0.0884) = 0.0848. No point over the pit is
// farther than 0.0884 from its rim. Bounds are exact to an eighth.
TEST(FaceDistance, SeesAPit) {
  TriangleMesh mesh = test::grid(8, 8);
  mesh.positions[2 * 9 + 5].z = -0.3F;
  const float bound = bound_of(mesh, {0, 8, 80}, 0.001F, 1.0F);
  EXPECT_GE(bound, 0.0847F);
  EXPECT_LE(bound, 0.0884F * 1.126F);
}

// A triangle across the corner between two upright walls: its middle is known to be far from both.
TEST(FaceDistance, SaysWhenItIsNotUseful) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}, {0, 1, 0}, {0, 1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 0, 3}, {4, 3, 5}};
  // The middle of the chord from (1, 0) to (0, 1) is 0.5 away from either wall, all else is nearer to one.
  EXPECT_EQ(bound_of(mesh, {1, 4, 5}, 0.01F, 0.4F), std::numeric_limits<float>::infinity());
  const float bound = bound_of(mesh, {1, 4, 5}, 0.01F, 1.0F);
  EXPECT_GE(bound, 0.5F);
  EXPECT_LE(bound, 0.5F * 1.125F + 1e-3F);
}

// Over the inside, beside an edge and beyond a corner of a right triangle, and of a sliver that has no inside.
TEST(TriangleBatch, KnowsInsideEdgesAndCorners) {
  const TriangleBatch triangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  EXPECT_FLOAT_EQ(triangle.squared_distance({1, 1, 3}), 9.0F);
  EXPECT_FLOAT_EQ(triangle.squared_distance({2, -3, 4}), 25.0F);
  EXPECT_FLOAT_EQ(triangle.squared_distance({7, 0, 4}), 25.0F);
  const TriangleBatch sliver({0, 0, 0}, {1, 0, 0}, {2, 0, 0});
  EXPECT_FLOAT_EQ(sliver.squared_distance({1.5F, 3, 0}), 9.0F);
  EXPECT_FLOAT_EQ(sliver.squared_distance({5, 4, 0}), 25.0F);
}

// Of two triangles one above the other the nearer is chosen for each point, in runs of any length.
TEST(TriangleBatch, ChoosesTheNearer) {
  PointBatch points;
  points.resize(300);
  for (std::size_t i = 0; i < 300; ++i) points.set(i, {0.1F, 0.1F, static_cast<float>(i) / 300.0F});
  std::vector<float> least(300, std::numeric_limits<float>::infinity());
  std::vector<std::uint32_t> chosen(300, no_id);
  TriangleBatch({0, 0, 0}, {1, 0, 0}, {0, 1, 0}).choose_nearer(points, 7, least.data(), chosen.data());
  TriangleBatch({0, 0, 1}, {1, 0, 1}, {0, 1, 1}).choose_nearer(points, 8, least.data(), chosen.data());
  for (std::size_t i = 0; i < 300; ++i) {
    const float z = points.z[i];
    EXPECT_EQ(chosen[i], z > 0.5F ? 8U : 7U) << i;
    EXPECT_NEAR(least[i], std::min(z * z, (1 - z) * (1 - z)), 1e-6F);
  }
}

}  // namespace
}  // namespace occlod
