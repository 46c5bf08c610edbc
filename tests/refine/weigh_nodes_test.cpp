#include "refine/weigh_nodes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <vector>

#include "refine_support.h"

namespace occlod {
namespace {

// Near and far, in front of the eye and behind it, around it, with cones of all widths and with none.
std::vector<FrontNode> random_nodes(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(-6.0F, 6.0F), part(0.0F, 1.0F);
  std::vector<FrontNode> nodes(count);
  for (FrontNode& node : nodes) {
    node.sphere = {{at(random), at(random), at(random)}, std::pow(10.0F, -4.0F + 5.0F * part(random))};
    node.cone = {glm::normalize(glm::vec3(at(random), at(random), at(random)) + glm::vec3(1e-3F)),
                 part(random) < 0.2F ? -1.0F : part(random)};
  }
  return nodes;
}

// Vectors do the same operations in the same order as the functions for one node, on every instruction set, so that a
// frame gives the same mesh on every machine; 4001 nodes leave a rest that fills no vector.
TEST(WeighNodes, ManyAtOnceAreAsOneByOne) {
  const View view(test::front_camera());
  for (const glm::dmat4& placed :
       {glm::dmat4(1.0), glm::scale(glm::dmat4(1.0), glm::dvec3(-1.0, 2.0, 0.5)),
        glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(0.5, 0.0, 1.0)), 0.7, glm::dvec3(0.6, 0.0, 0.8))})
    for (const bool tests_cones : {false, true}) {
      const ObjectView seen(view, placed);
      std::vector<FrontNode> nodes = random_nodes(4001, 3);
      const WeighedNodes counts = weigh_nodes(nodes, seen, tests_cones);
      WeighedNodes expected;
      for (const FrontNode& node : nodes) ASSERT_EQ(node.scale_px, scale_px_of(node, seen, tests_cones, expected));
      EXPECT_EQ(counts.outside, expected.outside);
      EXPECT_EQ(counts.facing_away, expected.facing_away);
      EXPECT_GT(counts.outside, 100U);
      EXPECT_EQ(counts.facing_away > 0U, tests_cones);
    }
}

// Straight from the hierarchy, where cones are packed: what the functions for one split say of each, bit for bit; 501
// nodes leave a rest that fills no vector.
TEST(WeighNodes, SplitsOfAHierarchyAreAsOneByOne) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(5, 1));
  const std::span<const SplitNode> nodes = hierarchy.data().nodes.first(501);
  const View view(test::front_camera());
  for (const glm::dmat4& placed : {glm::dmat4(1.0), glm::translate(glm::dmat4(1.0), glm::dvec3(1.2, 0.0, 2.5))})
    for (const bool tests_cones : {false, true}) {
      const ObjectView seen(view, placed);
      std::vector<float> scales(nodes.size());
      weigh_splits(nodes, seen, tests_cones, scales);
      std::size_t outside = 0, away = 0;
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        float expected = seen.largest_scale_px(nodes[i].sphere);
        if (tests_cones && faces_away(nodes[i].cone(), nodes[i].sphere, seen.eye())) expected = scale_facing_away;
        if (!seen.may_be_inside(nodes[i].sphere)) expected = scale_outside;
        ASSERT_EQ(scales[i], expected) << i;
        outside += expected == scale_outside ? 1 : 0;
        away += expected == scale_facing_away ? 1 : 0;
      }
      EXPECT_EQ(outside > 10U, placed != glm::dmat4(1.0));
      EXPECT_EQ(away > 10U, tests_cones);
    }
}

}  // namespace
}  // namespace occlod
