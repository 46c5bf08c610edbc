#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "base/threads.h"

namespace occlod {
namespace {

TEST(CompanionThread, DoesEachPieceOnceOnAnotherThread) {
  CompanionThread companion;
  int done = 0;
  std::thread::id where;
  const auto work = [&] {
    ++done;
    where = std::this_thread::get_id();
  };
  for (int i = 1; i <= 10'000; ++i) {
    companion.start(work);
    companion.finish();
    ASSERT_EQ(done, i);
  }
  EXPECT_NE(where, std::this_thread::get_id());
}

// Long enough for it to fall asleep.
TEST(CompanionThread, IsWokenAfterARest) {
  CompanionThread companion;
  int done = 0;
  const auto work = [&] { ++done; };
  for (int i = 1; i <= 3; ++i) {
    companion.start(work);
    companion.finish();
    EXPECT_EQ(done, i);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

// And while it works, the caller may fall asleep.
TEST(CompanionThread, IsWaitedFor) {
  CompanionThread companion;
  bool done = false;
  const auto work = [&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    done = true;
  };
  companion.start(work);
  companion.finish();
  EXPECT_TRUE(done);
}

TEST(CompanionThread, WhatItThrowsIsThrownByFinishOnce) {
  CompanionThread companion;
  const auto work = [] { throw std::runtime_error("damaged"); };
  companion.start(work);
  EXPECT_THROW(companion.finish(), std::runtime_error);
  EXPECT_NO_THROW(companion.finish());
  companion.start(work);
  companion.abandon();
  EXPECT_NO_THROW(companion.finish());
}

TEST(CompanionThread, NeedsNoWork) {
  CompanionThread companion;
  companion.finish();
  companion.abandon();
}

}  // namespace
}  // namespace occlod
