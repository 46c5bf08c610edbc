#include <gtest/gtest.h>

#include <cstddef>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <span>
#include <vector>

#include "raster/every_target.h"
#include "refine/refine_support.h"
#include "refine/weigh.h"

namespace occlod {
namespace {

// What the functions for one split say of each, bit for bit. Returns how often each special value is among them.
struct Found {
  std::size_t outside = 0, away = 0, infinite = 0;
};
Found compare_with_single_ones(std::span<const SplitNode> nodes, const ObjectView& seen, bool tests_cones) {
  std::vector<float> scales(nodes.size());
  weigh_splits(nodes, seen, tests_cones, scales);
  Found found;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    float expected = seen.largest_scale_px(nodes[i].sphere);
    if (tests_cones && faces_away(nodes[i].cone(), nodes[i].sphere, seen.eye())) expected = scale_facing_away;
    if (!seen.may_be_inside(nodes[i].sphere)) expected = scale_outside;
    EXPECT_EQ(scales[i], expected) << i;
    found.outside += expected == scale_outside ? 1U : 0U;
    found.away += expected == scale_facing_away ? 1U : 0U;
    found.infinite += expected == std::numeric_limits<float>::infinity() ? 1U : 0U;
  }
  return found;
}

// Straight from the hierarchy, where cones are packed; 501 nodes leave a rest that fills no vector. In front of the
// eye, partly beside the view, and around the eye, where scales have no limit.
TEST(WeighSplits, ManyAtOnceAreAsOneByOne) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(5, 1));
  const std::span<const SplitNode> nodes = hierarchy.data().nodes.first(501);
  const View view(test::front_camera());
  for (const glm::dvec3 offset : {glm::dvec3(0.0), glm::dvec3(1.2, 0.0, 2.5), glm::dvec3(0.0, 0.0, 3.2)})
    for (const bool tests_cones : {false, true}) {
      const ObjectView seen(view, glm::translate(glm::dmat4(1.0), offset));
      test::for_every_target([&](const char* target) {
        SCOPED_TRACE(target);
        const Found found = compare_with_single_ones(nodes, seen, tests_cones);
        EXPECT_EQ(found.outside > 10U, offset.z > 0.0);
        EXPECT_EQ(found.away > 10U, tests_cones);
        EXPECT_EQ(found.infinite > 0U, offset.z > 3.0);
      });
    }
}

}  // namespace
}  // namespace occlod
