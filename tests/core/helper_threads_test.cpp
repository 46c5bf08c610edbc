#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <stdexcept>

#include "base/threads.h"

namespace occlod {
namespace {

TEST(HelperThreads, WhatOneThrowsIsThrownByJoin) {
  // Without catching it on the other thread the program would be ended.
  HelperThreads threads;
  ASSERT_TRUE(threads.start([] { throw std::bad_alloc(); }));
  EXPECT_THROW(threads.join(), std::bad_alloc);
  EXPECT_NO_THROW(threads.join());  // once
}

TEST(HelperThreads, AllHaveEndedAfterJoin) {
  std::atomic<int> ended = 0;
  HelperThreads threads;
  for (int i = 0; i < 8; ++i)
    ASSERT_TRUE(threads.start([&ended, i] {
      ++ended;
      if (i % 2 == 0) throw std::runtime_error("even");
    }));
  EXPECT_THROW(threads.join(), std::runtime_error);
  EXPECT_EQ(ended, 8);
}

TEST(Parallel, AVisitThatThrowsEndsTheLoop) {
  // Of a million ranges each thread may have one under way when the fifth one fails; nobody begins another after that.
  constexpr std::size_t ranges = 1'000'000, failing = 5;
  for (const unsigned threads : {1U, 4U}) {
    std::atomic<std::size_t> visited = 0;
    const auto visit = [&](std::size_t begin, std::size_t) {
      if (begin == failing * range_size) throw std::bad_alloc();
      ++visited;
    };
    EXPECT_THROW(for_each_range(ranges * range_size, threads, visit), std::bad_alloc);
    EXPECT_GE(visited, threads == 1 ? failing : 0U);
    EXPECT_LT(visited, ranges / 2);
  }
}

TEST(Parallel, APartThatThrowsIsHeardOf) {
  for (const std::size_t failing : {0U, 3U})
    EXPECT_THROW(for_each_part(100, 4,
                               [&](std::size_t, std::size_t, std::size_t part) {
                                 if (part == failing) throw std::bad_alloc();
                               }),
                 std::bad_alloc);
}

}  // namespace
}  // namespace occlod
