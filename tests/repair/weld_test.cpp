#include "repair/weld.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <random>

namespace occlod::repair {
namespace {

TriangleMesh points(std::vector<glm::vec3> positions) {
  TriangleMesh mesh;
  mesh.positions = std::move(positions);
  return mesh;
}

TEST(Weld, NearestOfTheEarlierOnes) {
  // 0 and 1 are 1 apart and kept; 2 is 0.4 from 0 and 0.6 from 1; 3 is 0.5 from both: the smaller number.
  const TriangleMesh mesh = points({{0, 0, 0}, {1, 0, 0}, {0.4F, 0, 0}, {0.5F, 0, 0}, {5, 5, 5}});
  EXPECT_EQ(weld_targets(mesh, 0.75), (std::vector<VertexId>{0, 1, 0, 0, 4}));
}

TEST(Weld, DoesNotChain) {
  // Steps of 0.6 along a line, welded at 1: each second one stays, none moves farther than 1.
  TriangleMesh mesh;
  for (int i = 0; i < 10; ++i) mesh.positions.emplace_back(0.6F * static_cast<float>(i), 0, 0);
  const std::vector<VertexId> targets = weld_targets(mesh, 1.0);
  for (VertexId v = 0; v < targets.size(); ++v) EXPECT_EQ(targets[v], v / 2 * 2);
}

TEST(Weld, AgreesWithLookingAtAll) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> coordinate(-1.0F, 1.0F);
  TriangleMesh mesh;
  for (int i = 0; i < 2000; ++i)
    mesh.positions.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  const double distance = 0.15;
  const std::vector<VertexId> targets = weld_targets(mesh, distance);
  for (VertexId v = 0; v < targets.size(); ++v) {
    VertexId nearest = v;
    double best = distance;
    for (VertexId w = 0; w < v; ++w) {
      if (targets[w] != w) continue;
      const double d = glm::distance(glm::dvec3(mesh.positions[v]), glm::dvec3(mesh.positions[w]));
      if (d < best || (d == best && nearest == v)) nearest = w, best = d;
    }
    EXPECT_EQ(targets[v], nearest);
  }
}

TEST(Weld, CoordinatesOfAnySize) {
  // The distance is less than the step between floats there; and it is so large that all are in one cube.
  EXPECT_EQ(weld_targets(points({{1e30F, 0, 0}, {1.0001e30F, 0, 0}}), 1e-30), (std::vector<VertexId>{0, 1}));
  EXPECT_EQ(weld_targets(points({{1e-30F, 0, 0}, {2e-30F, 0, 0}, {3, 0, 0}}), 1e30), (std::vector<VertexId>{0, 0, 0}));
}

}  // namespace
}  // namespace occlod::repair
