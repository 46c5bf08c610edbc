#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "splits/collapse_worker.h"

namespace occlod {
namespace {

TEST(CollapseQueue, PopsLevelsInOrderWhateverIsMoved) {
  // Against the definition: what pops is on the lowest level of all that are in.
  constexpr std::uint32_t count = 200;
  CollapseQueue queue;
  queue.reset(count);
  std::mt19937 random(3);
  std::vector<float> costs(count, -1.0F);  // < 0: not in the queue
  for (int step = 0; step < 20000; ++step) {
    const auto item = static_cast<std::uint32_t>(random() % count);
    if (random() % 3 != 0) {
      queue.remove(item);
      costs[item] = std::ldexp(1.0F + static_cast<float>(random() % 64) / 64.0F, -static_cast<int>(random() % 90));
      queue.push(item, costs[item]);
      continue;
    }
    const std::uint32_t popped = queue.pop();
    std::uint32_t lowest = UINT32_MAX;
    for (const float cost : costs)
      if (cost >= 0.0F) lowest = std::min(lowest, CollapseQueue::level(cost));
    if (popped == CollapseQueue::none) {
      EXPECT_EQ(lowest, UINT32_MAX);
      continue;
    }
    ASSERT_GE(costs[popped], 0.0F);
    EXPECT_EQ(CollapseQueue::level(costs[popped]), lowest);
    costs[popped] = -1.0F;
  }
}

TEST(CollapseQueue, LevelsAreAThirtySecondOfAnOctaveWide) {
  EXPECT_EQ(CollapseQueue::level(1.0F), CollapseQueue::level(1.03F));
  EXPECT_LT(CollapseQueue::level(1.0F), CollapseQueue::level(1.04F));
  EXPECT_EQ(CollapseQueue::level(1.0F) + 32, CollapseQueue::level(2.0F));
  EXPECT_EQ(CollapseQueue::level(0.0F), 0U);
}

}  // namespace
}  // namespace occlod
