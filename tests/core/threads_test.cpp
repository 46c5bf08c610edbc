#include "base/threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <new>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace occlod {
namespace {

using namespace std::chrono_literals;

// Waits until `count` has the value, but for a minute at most.
void wait_for(const std::atomic<unsigned>& count, unsigned value) {
  const auto end = std::chrono::steady_clock::now() + 60s;
  while (count < value && std::chrono::steady_clock::now() < end) std::this_thread::yield();
}

TEST(SharedWork, IsDoneByOtherThreadsWithNumbersOfTheirOwn) {
  SharedWork shared;
  for (int round = 0; round < 100; ++round) {
    std::vector<std::thread::id> by(5);
    std::atomic<unsigned> begun = 0;
    const auto work = [&](unsigned number) {
      by.at(number) = std::this_thread::get_id();
      ++begun;
      wait_for(begun, 4);
    };
    shared.start(4, work);
    wait_for(begun, 4);
    shared.finish();
    EXPECT_EQ(begun, 4U);
    by[0] = std::this_thread::get_id();
    EXPECT_EQ(std::set(by.begin(), by.end()).size(), 5U);
  }
}

TEST(SharedWork, MakesNoThreadTwice) {
  std::set<std::thread::id> seen;
  for (int round = 0; round < 1000; ++round) {
    std::atomic<unsigned> begun = 0;
    std::thread::id by;
    const auto work = [&](unsigned) {
      by = std::this_thread::get_id();
      ++begun;
    };
    SharedWork shared;
    shared.start(1, work);
    wait_for(begun, 1);
    shared.finish();
    seen.insert(by);
  }
  EXPECT_LE(seen.size(), 4U);  // those of the test before
}

// The pauses are long enough for the pool's threads to fall asleep, and for the caller while it waits.
TEST(SharedWork, IsBegunAfterARestAndWaitedFor) {
  for (int round = 0; round < 3; ++round) {
    std::atomic<unsigned> begun = 0;
    bool done = false;
    const auto work = [&](unsigned) {
      ++begun;
      std::this_thread::sleep_for(20ms);
      done = true;
    };
    SharedWork shared;
    shared.start(1, work);
    wait_for(begun, 1);
    shared.finish();
    EXPECT_TRUE(done);
    std::this_thread::sleep_for(20ms);
  }
}

// Whoever is late finds nothing to do.
TEST(SharedWork, IsOverWhenItHasBeenFinished) {
  SharedWork shared;
  for (int round = 0; round < 10'000; ++round) {
    std::atomic<bool> is_over = false;
    std::atomic<unsigned> late = 0;
    const auto work = [&](unsigned) { late += is_over ? 1 : 0; };
    shared.start(3, work);
    shared.finish();
    is_over = true;
    ASSERT_EQ(late, 0U);
  }
}

TEST(SharedWork, WhatItThrowsIsThrownByFinishOnce) {
  std::atomic<unsigned> begun = 0;
  const auto work = [&](unsigned) {
    ++begun;
    throw std::runtime_error("damaged");
  };
  SharedWork shared;
  shared.start(1, work);
  wait_for(begun, 1);
  EXPECT_THROW(shared.finish(), std::runtime_error);
  EXPECT_NO_THROW(shared.finish());
  shared.start(1, work);
  wait_for(begun, 2);
  shared.abandon();
  EXPECT_NO_THROW(shared.finish());
}

TEST(SharedWork, MayNeedNobody) {
  SharedWork shared;
  shared.finish();
  shared.abandon();
  shared.start(0, [](unsigned) { FAIL(); });
  shared.finish();
}

// Each of several threads shares work whose parts share work themselves. All of it is done however few threads help.
TEST(Share, ManyMayShareAndWithin) {
  std::atomic<unsigned> done = 0;
  std::vector<std::thread> callers;
  for (int caller = 0; caller < 4; ++caller)
    callers.emplace_back([&] {
      for (int round = 0; round < 50; ++round)
        for_each_task(8, 3, [&](std::size_t) { for_each_task(4, 3, [&](std::size_t) { ++done; }); });
    });
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(done, 4U * 50 * 8 * 4);
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
