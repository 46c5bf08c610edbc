// Stars bounded together must get what each would get alone.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "occlod/hierarchy.h"
#include "splits/star.h"
#include "splits/star_patch.h"
#include "splits/star_record.h"

namespace occlod {
namespace {

struct ClosedFan {
  std::vector<glm::vec3> positions;  // the ring, then the vertex
  std::vector<VertexId> ring;
  VertexId parent = 0;

  [[nodiscard]] VertexId vertex() const { return static_cast<VertexId>(ring.size()); }
  // As bound_star() sees it.
  [[nodiscard]] BoundedPatch bound_alone() const {
    std::vector<FaceRef> removed;
    for (std::uint32_t slot = 0; slot + 2 < ring.size(); ++slot) removed.push_back({slot, slot % 16});
    std::vector<std::uint32_t> words;
    EXPECT_TRUE(append_fan({ring, parent, removed}, words));
    return bound_star(SplitStar(words.data(), vertex()), positions);
  }
};

// Around a vertex somewhere near `origin`; `height` above and below its plane, in radii.
ClosedFan random_fan(std::size_t corners, const glm::vec3& origin, float radius, float height, std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  ClosedFan fan;
  for (std::size_t k = 0; k < corners; ++k) {
    const float angle = 6.2831853F * (static_cast<float>(k) + 0.5F * unit(random)) / static_cast<float>(corners);
    const glm::vec3 offset(std::cos(angle), std::sin(angle), height * (unit(random) - 0.5F));
    fan.positions.push_back(origin + radius * (0.5F + unit(random)) * offset);
  }
  fan.positions.push_back(origin + radius * 0.2F * glm::vec3(unit(random), unit(random), unit(random)));
  fan.ring.resize(corners);
  std::iota(fan.ring.begin(), fan.ring.end(), 0U);
  fan.parent = static_cast<VertexId>(random() % corners);
  return fan;
}

void expect_same(const BoundedPatch& a, const BoundedPatch& b) {
  EXPECT_EQ(a.box.min, b.box.min);
  EXPECT_EQ(a.box.max, b.box.max);
  EXPECT_EQ(a.patch.axis, b.patch.axis);
  EXPECT_EQ(a.patch.cos_angle, b.patch.cos_angle);
  EXPECT_EQ(a.patch.sin_angle, b.patch.sin_angle);
  EXPECT_EQ(a.patch.has_normal, b.patch.has_normal);
}

TEST(FanPatches, AreThoseOfEachFanAlone) {
  std::mt19937 random(3);
  int bounded = 0;
  for (std::size_t corners = 3; corners <= 16; ++corners)
    for (const float height : {0.0F, 0.4F, 3.0F}) {
      FanPatches fans;
      std::vector<ClosedFan> all;
      const std::size_t count = 1 + random() % FanPatches::capacity;
      for (std::size_t i = 0; i < count; ++i) {
        all.push_back(random_fan(corners, {3.0F, -7.0F, 0.5F}, 0.1F, height, random));
        const ClosedFan& fan = all.back();
        fans.add(fan.vertex(), fan.ring, fan.parent, fan.positions);
      }
      const FanPatchBounds bounds = fans.bounds();
      for (std::size_t i = 0; i < count; ++i) {
        if (bounds.is_bounded[i] == 0.0F) continue;
        expect_same(bounds[i], all[i].bound_alone());
        ++bounded;
      }
    }
  EXPECT_GT(bounded, 100);
}

TEST(FanPatches, LeaveSliversAndExtremeSizesToBoundStar) {
  std::mt19937 random(4);
  for (const float radius : {1e-20F, 1e20F}) {
    FanPatches fans;
    const ClosedFan fan = random_fan(6, glm::vec3(0.0F), radius, 0.4F, random);
    fans.add(fan.vertex(), fan.ring, fan.parent, fan.positions);
    EXPECT_EQ(fans.bounds().is_bounded[0], 0.0F) << radius;
  }
  ClosedFan sliver = random_fan(6, glm::vec3(0.0F), 1.0F, 0.4F, random);
  sliver.positions[1] = sliver.positions[0] + glm::vec3(1e-4F, 0.0F, 0.0F);
  FanPatches fans;
  fans.add(sliver.vertex(), sliver.ring, sliver.parent, sliver.positions);
  EXPECT_EQ(fans.bounds().is_bounded[0], 0.0F);
}

}  // namespace
}  // namespace occlod
