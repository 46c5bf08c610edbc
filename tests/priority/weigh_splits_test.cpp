#include "priority/weigh_splits.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "refine/refine_support.h"

namespace occlod {
namespace {

// Straight from the hierarchy, where cones are packed: what the functions for one split say of each, bit for bit; 501
// nodes leave a rest that fills no vector.
TEST(WeighSplits, ManyAtOnceAreAsOneByOne) {
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
