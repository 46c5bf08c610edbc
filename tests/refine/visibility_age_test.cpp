// How long ago what is in the mesh was last found visible.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "occlod/visibility.h"
#include "refine/refine_support.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

class VisibilityAges : public testing::Test {
 protected:
  // The next frame, a little further around the planet.
  const Refinement& step(Visibility& visibility) {
    Camera camera = test::front_camera();
    camera.eye.x += 0.05 * frame_++;
    RefineOptions options;
    options.budget = 1'500;
    tune(options).final_check = false;  // one occluder a frame
    return refiner_.update(View(camera), options, visibility);
  }
  [[nodiscard]] std::size_t count(std::uint32_t age) const {
    const std::vector<std::uint32_t> ages = refiner_.visibility_ages(0);
    return static_cast<std::size_t>(std::count(ages.begin(), ages.end(), age));
  }

  Hierarchy planet_ = build_hierarchy(test::noisy_sphere(5, 3));
  Refiner refiner_{std::vector<RefineObject>{{.hierarchy = &planet_}}};
  std::unique_ptr<Visibility> software_ = make_software_occlusion();
  int frame_ = 0;
};

// Everything has been judged for this very mesh.
TEST_F(VisibilityAges, AreZeroFromScratch) {
  const Refinement& first = step(*software_);
  EXPECT_EQ(count(0), first.objects[0].splits.size());
  RefineOptions options;
  options.budget = 1'500;
  const Refinement& again = refiner_.refine(View(test::front_camera()), options, *software_);
  EXPECT_EQ(count(0), again.objects[0].splits.size());
}

// Each frame draws one occluder, asks about some and leaves the others a frame older: no age is larger than the number
// of frames since refinement from scratch. What has nothing below it has the age of its own answer; what has is no
// older than that.
TEST_F(VisibilityAges, GrowByOneAFrameUntilTheNextAnswer) {
  (void)step(*software_);
  std::map<SplitId, std::uint32_t> before;
  for (std::uint32_t frame = 1; frame <= 6; ++frame) {
    const Refinement& refinement = step(*software_);
    ASSERT_EQ(refinement.stats.occluder_draws, 1U);
    ASSERT_LT(refinement.stats.new_splits, refinement.stats.splits);  // it has gone on
    const std::vector<std::uint32_t> ages = refiner_.visibility_ages(0);
    const std::vector<SplitId>& splits = refinement.objects[0].splits;
    ASSERT_EQ(ages.size(), splits.size());
    std::map<SplitId, std::uint32_t> now;
    for (std::size_t i = 0; i < splits.size(); ++i) now[splits[i]] = ages[i];
    EXPECT_GT(count(0), 0U);
    for (const auto& [split, age] : now) {
      EXPECT_TRUE(age < frame || age == never_asked) << frame;
      const SplitNode& node = planet_.node(split);
      if (const auto parent = now.find(node.parent); parent != now.end()) {
        EXPECT_LE(parent->second, age);
      }
      const bool is_lowest = !now.contains(node.child_u) && !now.contains(node.child_v) &&
                             !before.contains(node.child_u) && !before.contains(node.child_v);
      if (const auto old = before.find(split); is_lowest && old != before.end() && age != 0) {
        EXPECT_EQ(age, old->second == never_asked ? never_asked : old->second + 1);
      }
    }
    before = std::move(now);
  }
  EXPECT_LT(count(never_asked), before.size() * 2 / 3);  // leaves are asked about in turns of eight frames
}

// Without occlusion nothing is drawn, and nothing ages.
TEST_F(VisibilityAges, StayZeroWithoutOcclusion) {
  NoOcclusion none;
  (void)step(none);
  const Refinement& second = step(none);
  EXPECT_EQ(count(0), second.objects[0].splits.size());
}

}  // namespace
}  // namespace occlod
