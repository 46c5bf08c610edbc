#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "base/file_input.h"
#include "base/memory.h"
#include "base/platform.h"
#include "base/threads.h"
#include "occlod/base.h"

namespace occlod {
namespace {

constexpr std::size_t mebibyte = std::size_t{1} << 20U;

class MemoryLimitTest : public ::testing::Test {
 protected:
  MemoryLimitTest() : folder_(std::filesystem::path(::testing::TempDir()) / "occlod_memory_limit") {
    std::filesystem::create_directories(folder_);
  }
  ~MemoryLimitTest() override { std::filesystem::remove_all(folder_); }

  std::string refusal(std::size_t bytes, const std::filesystem::path& folder) {
    try {
      const MemoryLimit limit(bytes, folder);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
};

TEST_F(MemoryLimitTest, KeepsContentsAndMostOfThemOutOfMemory) {
  const std::size_t before = resident_memory().all;
  const MemoryLimit limit(before + 64 * mebibyte, folder_);
  LargeVector<std::uint64_t> numbers(64 * mebibyte);  // 512 MiB
  std::iota(numbers.begin(), numbers.end(), std::uint64_t{0});
  // The thread that watches may be late, but not by hundreds of megabytes.
  EXPECT_LT(resident_memory().all, before + 448 * mebibyte);
  EXPECT_GE(limit.max_scratch_bytes(), 512 * mebibyte);
  EXPECT_TRUE(std::filesystem::is_empty(folder_)) << "files without names";
  for (std::size_t i = 0; i < numbers.size(); i += 997) ASSERT_EQ(numbers[i], i);
}

// A read may bring in as much as 2 MiB, so these of 512 MiB in no order bring in more than the thread that watches can
// keep up with.
TEST_F(MemoryLimitTest, LoopsInNoOrderStayBelowIt) {
  constexpr std::size_t count = 128 * mebibyte;  // 512 MiB
  const std::size_t limit_bytes = resident_memory().all + 256 * mebibyte;
  const MemoryLimit limit(limit_bytes, folder_);
  LargeVector<std::uint32_t> numbers(count, 1);
  std::atomic<std::size_t> most = 0, sum = 0;
  for_each_id(std::size_t{1} << 14U, 2, [&](std::uint32_t i) {
    sum += numbers[std::uint64_t{i} * 0x9e3779b97f4a7c15ULL >> 37U];
    if (i % 32 != 0) return;
    const std::size_t now = resident_memory().all;
    for (std::size_t before = most; before < now && !most.compare_exchange_weak(before, now);) continue;
  });
  EXPECT_EQ(sum, std::size_t{1} << 14U);
  EXPECT_LT(most, limit_bytes);
}

// Pages of a file that is mapped for reading count as the process's memory, so they leave with those of scratch files.
TEST_F(MemoryLimitTest, PagesOfMappedFilesLeave) {
  const std::filesystem::path file = folder_ / "mapped";
  {
    const std::vector<char> some(mebibyte, 'a');
    std::ofstream stream(file, std::ios::binary);
    for (int i = 0; i < 256; ++i) stream.write(some.data(), static_cast<std::streamsize>(some.size()));
  }
  const std::size_t limit_bytes = resident_memory().all + 128 * mebibyte;
  const MemoryLimit limit(limit_bytes, folder_);
  const MappedFile mapped(file);
  std::size_t most = 0;
  for (std::size_t i = 0; i < mapped.bytes().size(); i += 4096) {
    make_room();
    ASSERT_EQ(mapped.bytes()[i], std::byte{'a'});
    if (i % (64 * 4096) == 0) most = std::max(most, resident_memory().all);
  }
  EXPECT_LT(most, limit_bytes);
}

TEST_F(MemoryLimitTest, WhatOutlivesItIsStillThere) {
  LargeVector<std::uint32_t> numbers;
  {
    const MemoryLimit limit(std::size_t{8} << 30U, folder_);
    numbers.assign(4 * mebibyte, 7);
    EXPECT_EQ(limit.max_scratch_bytes(), 16 * mebibyte);
  }
  EXPECT_EQ(std::accumulate(numbers.begin(), numbers.end(), std::uint64_t{0}), 7 * 4 * mebibyte);
  LargeVector<std::uint32_t>().swap(numbers);
  const MemoryLimit next(std::size_t{8} << 30U, folder_);
  EXPECT_EQ(next.max_scratch_bytes(), 0U) << "it was given back";
}

TEST_F(MemoryLimitTest, SmallArraysStayInMemory) {
  const MemoryLimit limit(std::size_t{8} << 30U, folder_);
  const LargeVector<std::uint32_t> numbers(mebibyte, 7);
  EXPECT_EQ(limit.max_scratch_bytes(), 0U);
}

TEST_F(MemoryLimitTest, RefusesWhatCannotBeKept) {
  EXPECT_NE(refusal(mebibyte, folder_).find("less than 64 MiB"), std::string::npos);
  EXPECT_NE(refusal(std::size_t{1} << 30U, folder_ / "missing").find("missing"), std::string::npos);
  const MemoryLimit first(std::size_t{8} << 30U, folder_);
  EXPECT_NE(refusal(std::size_t{8} << 30U, folder_).find("there is one already"), std::string::npos);
}

// As on a full disk.
TEST_F(MemoryLimitTest, AFullDiskIsAnErrorAndNoSignal) {
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old), 0);
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  const rlimit small{16 * mebibyte, old.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string message;
  {
    const MemoryLimit limit(std::size_t{8} << 30U, folder_);
    const LargeVector<std::byte> fits(12 * mebibyte);
    try {
      const LargeVector<std::byte> too_large(32 * mebibyte);
    } catch (const Error& error) {
      message = error.what();
    }
  }
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old), 0);
  signal(SIGXFSZ, handler);
  EXPECT_NE(message.find("has no room for 33 MiB more of scratch, beside 12 MiB"), std::string::npos) << message;
}

}  // namespace
}  // namespace occlod
