// The quick way must say what the general one says.
#include "splits/fan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "splits/collapse_rules.h"
#include "support/meshes.h"

namespace occlod {
namespace {

float movement(const Fan& fan, std::size_t i) {
  FanMovements one;
  one.add(fan, i);
  return one.bounds()[0];
}

void expect_same_answers(const StarMesh& mesh, std::span<const glm::vec3> positions, VertexId v, int& compared) {
  Fan fan;
  if (!fan.gather(mesh, v)) return;
  fan.measure_offsets([&](VertexId w) { return positions[w]; });
  fan.measure_normals();
  VertexRing ring;
  ring.gather(mesh, v);
  ASSERT_EQ(fan.size(), ring.neighbours().size());
  ChangeBound general_bound;
  for (std::size_t i = 0; i < fan.size(); ++i) {
    const VertexId u = fan.ring()[i];
    const auto at = std::lower_bound(ring.neighbours().begin(), ring.neighbours().end(), u) - ring.neighbours().begin();
    EXPECT_EQ(fan.keeps_topology(mesh, i), keeps_topology(mesh, ring, static_cast<std::size_t>(at)));
    EXPECT_EQ(fan.keeps_orientation(i), keeps_orientation(mesh, positions, v, u));
    const double general = general_bound(positions, ring, u);
    EXPECT_NEAR(static_cast<double>(movement(fan, i)), general, 1e-4 * general + 1e-6);
    ++compared;
  }
}

TEST(Fan, AgreesWithTheGeneralRulesWhileAMeshIsTakenApart) {
  // A torus three faces round has empty triangles of edges; a noisy sphere has folds; random collapses make all kinds
  // of stars.
  for (const TriangleMesh& input :
       {test::noisy_sphere(3, 7), test::torus(12, 3), test::torus(10, 8), test::grid(8, 8)}) {
    StarMesh mesh(input.triangles, input.vertex_count());
    StarArena arena;
    std::mt19937 random(11);
    std::vector<VertexId> around;
    std::vector<LevelFace> ended;
    int compared = 0;
    for (int n = 0; n < 2000; ++n) {
      const auto v = static_cast<VertexId>(random() % input.vertex_count());
      if (mesh.star(v).empty()) continue;
      expect_same_answers(mesh, input.positions, v, compared);
      mesh.neighbours(v, around);
      VertexRing ring;
      ring.gather(mesh, v);
      const std::size_t i = random() % around.size();
      if (keeps_topology(mesh, ring, i)) (void)mesh.collapse(v, around[i], 0, false, arena, ended);
    }
    EXPECT_GT(compared, 200);
  }
}

TEST(Fan, ATentFallsByNoLessThanItsHeight) {
  // Its corners are at height 0 exactly, so whatever replaces it is a whole height below its apex.
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  for (int tries = 0; tries < 2000; ++tries) {
    const int n = 5 + tries % 8;
    TriangleMesh tent = test::fan(n);
    for (int i = 0; i < n; ++i) {
      const float angle = 6.2831853F * static_cast<float>(i) / static_cast<float>(n);
      tent.positions[static_cast<std::size_t>(i) + 1] = {std::cos(angle), std::sin(angle), 0.0F};
    }
    tent.positions[0] = {0.0F, 0.0F, 0.3F * unit(random)};
    const StarMesh mesh(tent.triangles, tent.vertex_count());
    Fan fan;
    ASSERT_TRUE(fan.gather(mesh, 0));
    fan.measure_offsets([&](VertexId w) { return tent.positions[w]; });
    fan.measure_normals();
    for (std::size_t i = 0; i < fan.size(); ++i) EXPECT_GE(movement(fan, i), tent.positions[0].z);
  }
}

TEST(Fan, IsOnlyOneClosedFan) {
  Fan fan;
  const auto gathers = [&](const TriangleMesh& mesh, VertexId v) {
    return fan.gather(StarMesh(mesh.triangles, mesh.vertex_count()), v);
  };
  EXPECT_TRUE(gathers(test::fan(6), 0));
  EXPECT_FALSE(gathers(test::fan(6), 1));  // on the boundary
  EXPECT_FALSE(gathers(test::bow_tie(), 0));
  EXPECT_FALSE(gathers(test::book(3), 0));
  EXPECT_FALSE(gathers(test::double_sided_quad(), 0));
  EXPECT_FALSE(gathers(test::fan(static_cast<int>(Fan::max_neighbours) + 1), 0));  // too large for the quick way
  TriangleMesh two_fans = test::tetrahedron();                                     // two tetrahedra that share vertex 0
  two_fans.positions.resize(7);
  for (Triangle t : test::tetrahedron().triangles) {
    for (int k = 0; k < 3; ++k) t[k] = t[k] == 0 ? 0 : t[k] + 3;
    two_fans.triangles.push_back(t);
  }
  EXPECT_FALSE(gathers(two_fans, 0));
  EXPECT_TRUE(gathers(two_fans, 5));
}

}  // namespace
}  // namespace occlod
