#include "refine/queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <vector>

namespace occlod {
namespace {

Entry entry_of(float priority, SplitId split) {
  Entry entry;
  entry.priority = priority;
  entry.split = split;
  return entry;
}

std::vector<SplitId> drain(Queue& queue) {
  std::vector<SplitId> splits;
  while (!queue.empty()) splits.push_back(queue.pop().split);
  return splits;
}

TEST(Queue, WorstComesFirstAndOfEqualOnesTheLast) {
  Queue queue;
  queue.push(entry_of(1.0F, 0));
  queue.push(entry_of(4.0F, 1));
  queue.push(entry_of(0.0F, 2));
  queue.push(entry_of(4.0F, 3));
  queue.push(entry_of(std::numeric_limits<float>::infinity(), 4));
  queue.push(entry_of(1e-40F, 5));
  EXPECT_EQ(drain(queue), (std::vector<SplitId>{4, 3, 1, 0, 5, 2}));
}

TEST(Queue, WouldBeNextAgreesWithWhatComesOut) {
  Queue queue;
  EXPECT_TRUE(queue.would_be_next(entry_of(0.0F, 0)));
  queue.push(entry_of(2.0F, 1));
  EXPECT_FALSE(queue.would_be_next(entry_of(1.9F, 2)));  // 2 is the lower end of a bucket
  EXPECT_TRUE(queue.would_be_next(entry_of(2.0F, 3)));
  queue.push(entry_of(2.0F, 3));
  EXPECT_EQ(queue.top().split, 3U);
}

// Random pushes and pops beside a map of everything that is inside: nothing is lost or doubled, and what comes out is
// within 2^(1/64) of the largest, since a bucket spans a sixty-fourth of an octave's linear range.
TEST(Queue, ComesOutInOrderAndWhole) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> exponent(-20.0F, 20.0F);
  Queue queue;
  std::multimap<float, SplitId> inside;
  for (SplitId step = 0; step < 20'000; ++step) {
    if (inside.empty() || random() % 3 != 0) {
      const float priority = std::exp2(exponent(random));
      queue.push(entry_of(priority, step));
      inside.emplace(priority, step);
    } else {
      const float largest = inside.rbegin()->first;
      const Entry entry = queue.pop();
      EXPECT_GE(entry.priority * (1.0F + 1.0F / 64.0F), largest);
      const auto [first, last] = inside.equal_range(entry.priority);
      const auto at = std::find_if(first, last, [&](const auto& item) { return item.second == entry.split; });
      ASSERT_NE(at, last);
      inside.erase(at);
    }
  }
  std::multimap<float, SplitId> seen;
  queue.for_each([&](const Entry& entry) { seen.emplace(entry.priority, entry.split); });
  EXPECT_TRUE(std::is_permutation(seen.begin(), seen.end(), inside.begin(), inside.end()));
  queue.clear();
  EXPECT_TRUE(queue.empty());
  queue.for_each([&](const Entry&) { FAIL(); });
}

// More in one bucket than a chunk holds, and buckets words apart.
TEST(Queue, ForEachGoesThroughItInTheOrderOfPops) {
  Queue queue;
  for (SplitId s = 0; s < 100; ++s) queue.push(entry_of(std::exp2(static_cast<float>(s * 7 % 10 * 5) - 20.0F), s));
  std::vector<SplitId> order;
  queue.for_each([&](const Entry& entry) { order.push_back(entry.split); });
  ASSERT_EQ(order.size(), 100U);
  for (const SplitId s : order) EXPECT_EQ(queue.pop().split, s);
}

}  // namespace
}  // namespace occlod
