#include "occlod/hlod/metric.h"

#include <gtest/gtest.h>

#include <random>

#include "occlod/hlod/build.h"
#include "occlod/mesh/generate.h"
#include "support/meshes.h"

namespace occlod::hlod {
namespace {

TEST(ScreenError, TheLargerOfTwoTerms) {
  Node node;
  node.box = {glm::vec3(1.0F, -1.0F, -1.0F), glm::vec3(3.0F, 1.0F, 1.0F)};
  node.lod_box = {glm::vec3(0.0F, -1.0F, -1.0F), glm::vec3(3.0F, 1.0F, 1.0F)};
  node.sphere = {glm::vec3(2.0F, 0.0F, 0.0F), 2.0F};
  node.error = 0.1F;
  node.child_error = 0.05F;
  const auto at = [](const glm::dvec3& eye) { return ScreenScale{eye, 1000.0, 0.01}; };
  // 5 from the box, 4 from the lod_box: 1000 * max(0.1 / 5, 0.05 / 4).
  EXPECT_NEAR(screen_error_px(node, at({-4.0, 0.0, 0.0})), 20.0, 1e-5);
  // 1.2 and 0.2: 1000 * max(0.1 / 1.2, 0.05 / 0.2).
  EXPECT_NEAR(screen_error_px(node, at({-0.2, 0.0, 0.0})), 250.0, 1e-4);
  // Off a corner: (1, 1, 1) beyond, sqrt 3 away from both.
  EXPECT_NEAR(screen_error_px(node, at({4.0, 2.0, 2.0})), 100.0 / std::sqrt(3.0), 1e-5);
  // Inside counts as at the near plane.
  EXPECT_NEAR(screen_error_px(node, at({2.0, 0.0, 0.0})), 1000.0 * 0.1 / 0.01, 1e-3);
  // 6 from the centre, 4 from the sphere.
  EXPECT_NEAR(sphere_error_px(node, at({-4.0, 0.0, 0.0})), 25.0, 1e-5);
  EXPECT_NEAR(sphere_error_px(node, at({2.0, 1.0, 0.0})), 1000.0 * 0.1 / 0.01, 1e-3);
}

// From far away to within the mesh, and exactly on corners of boxes.
std::vector<glm::dvec3> eyes_around(const Hlod& hlod) {
  std::mt19937_64 random(3);
  const auto number = [&] { return static_cast<double>(random() % 20'001) / 10'000.0 - 1.0; };
  std::vector<glm::dvec3> eyes;
  for (const double reach : {0.3, 1.0, 1.1, 3.0, 100.0, 1e7})
    for (int i = 0; i < 20; ++i) eyes.push_back(reach * glm::dvec3(number(), number(), number()));
  for (int i = 0; i < 40; ++i)
    eyes.emplace_back(corner(hlod.node(static_cast<NodeId>(random() % hlod.node_count())).box, i % 8));
  return eyes;
}

TEST(ScreenError, IsNeverLessThanAChilds) {
  for (const Grouping grouping : {Grouping::shifted, Grouping::nested})
    for (const TriangleMesh& mesh :
         {occlod::test::noisy_sphere(6, 1), generate_city({.blocks = 3, .facade_cells = 8})}) {
      BuildOptions options;
      options.node_triangles = 64;
      options.grouping = grouping;
      const Hlod hlod = build_hlod(mesh, options);
      for (const glm::dvec3& eye : eyes_around(hlod)) {
        const ScreenScale scale{eye, 935.0, 1e-4};
        for (NodeId n = 0; n < hlod.node_count(); ++n)
          for (const NodeId child : hlod.children(n)) {
            EXPECT_GE(screen_error_px(hlod.node(n), scale), screen_error_px(hlod.node(child), scale));
            EXPECT_GE(sphere_error_px(hlod.node(n), scale), sphere_error_px(hlod.node(child), scale));
          }
      }
    }
}

}  // namespace
}  // namespace occlod::hlod
