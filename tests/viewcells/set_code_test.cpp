#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "cells/vlod_payload.h"

namespace occlod {
namespace {

using Numbers = std::vector<std::uint64_t>;

std::size_t bits_of(const Numbers& numbers) {
  BitWriter writer;
  put_numbers(writer, numbers);
  const std::size_t bytes = writer.take().size();
  // What it takes with one more bit tells how many bits the last byte has.
  for (unsigned more = 1; more <= 8; ++more) {
    put_numbers(writer, numbers);
    writer.put(0, more);
    if (writer.take().size() > bytes) return 8 * bytes - (more - 1);
  }
  return 0;
}

// Runs of all kinds of lengths and gaps.
Numbers random_set(std::mt19937& random, std::uint64_t end) {
  Numbers set;
  const std::uint64_t gap = 1ULL << (random() % 12), length = 1ULL << (random() % 5);
  const std::size_t most = random() % 40;
  for (std::uint64_t at = random() % gap; at < end && set.size() < most; at += 1 + random() % gap)
    for (std::uint64_t n = 1 + random() % length; n > 0 && at < end; --n) set.push_back(at++);
  set.erase(std::unique(set.begin(), set.end()), set.end());
  return set;
}

TEST(SetCode, TakesTheFewestBits) {
  // A tag of four bits, and: one bit a zero with Rice 0; 1 + 10 with Rice 10 for numbers below 1024.
  EXPECT_EQ(bits_of({0, 0, 0, 0}), 4U + 4U);
  EXPECT_EQ(bits_of({1023, 1000, 900, 800}), 4U + 4U * 11U);
  // Gamma takes 1 bit for 0 and 2 * 20 + 1 for 2^20 - 1; Rice codes far more for one of them.
  Numbers skewed(200, 0);
  skewed.push_back((1U << 20U) - 1);
  EXPECT_EQ(bits_of(skewed), 4U + 200U + 41U);
  // Seven bits of 21 a group of eight: three groups, where gamma takes 41.
  EXPECT_EQ(bits_of({(1U << 21U) - 2, (1U << 21U) - 2, (1U << 21U) - 2}), 4U + 3U * 24U);
}

TEST(SetCode, RandomSetsComeBack) {
  std::mt19937 random(1);
  Numbers back;
  for (int n = 0; n < 200'000; ++n) {
    const std::uint64_t end = n % 10 == 0 ? 1ULL << 40U : 1 + random() % 5000;
    const Numbers set = random_set(random, end);
    BitWriter writer;
    put_set(writer, set);
    put_set(writer, set);
    const std::vector<std::byte> bytes = writer.take();
    BitReader reader(bytes);
    for (int twice = 0; twice < 2; ++twice) {  // so it ends where it ends
      back.clear();
      ASSERT_TRUE(get_set(reader, end, set.size(), back));
      ASSERT_EQ(back, set);
    }
    ASSERT_TRUE(reader.rest_is_zero());
    if (set.empty()) continue;
    BitReader lower(bytes), fewer(bytes);
    back.clear();
    ASSERT_FALSE(get_set(lower, set.back(), set.size(), back)) << "the last is out of range";
    ASSERT_FALSE(get_set(fewer, end, set.size() - 1, back)) << "there are more";
  }
}

TEST(SetCode, NumbersComeBackWithEveryCode) {
  std::mt19937_64 random(2);
  std::set<std::uint64_t> tags;
  Numbers back;
  for (int n = 0; n < 20'000; ++n) {
    const auto bits = 1 + random() % 39, spread = 1 + random() % bits;
    Numbers numbers(1 + random() % 20);
    for (std::uint64_t& number : numbers) number = random() >> (64 - (n % 2 == 0 ? bits : 1 + random() % spread));
    BitWriter writer;
    put_numbers(writer, numbers);
    const std::vector<std::byte> bytes = writer.take();
    tags.insert(std::to_integer<std::uint64_t>(bytes[0]) & 15U);
    BitReader reader(bytes);
    ASSERT_TRUE(get_numbers(reader, numbers.size(), back));
    ASSERT_EQ(back, numbers);
  }
  EXPECT_EQ(tags.size(), 16U);
}

// Whatever the bytes, what is read is a set within its limits, or nothing.
TEST(SetCode, DamageNeverGivesWhatIsNoSet) {
  std::mt19937 random(3);
  Numbers back;
  int refused = 0;
  for (int n = 0; n < 100'000; ++n) {
    BitWriter writer;
    put_set(writer, random_set(random, 4000));
    std::vector<std::byte> bytes = writer.take();
    for (auto flips = 1 + random() % 3; flips > 0; --flips)
      bytes[random() % bytes.size()] ^= std::byte(1U << (random() % 8));
    if (random() % 2 == 0) bytes.resize(random() % (bytes.size() + 1));
    BitReader reader(bytes);
    back.clear();
    const bool is_set = get_set(reader, 4000, 300, back);
    refused += is_set ? 0 : 1;
    ASSERT_LE(back.size(), 300U);
    ASSERT_TRUE(std::is_sorted(back.begin(), back.end(), std::less_equal<>()) || back.size() < 2);
    ASSERT_TRUE(back.empty() || back.back() < 4000U);
  }
  EXPECT_GT(refused, 30'000);
}

TEST(SetCode, HugeClaimsAreRefusedAtOnce) {
  Numbers back;
  BitWriter writer;
  writer.put_gamma(1ULL << 50U);  // runs
  const std::vector<std::byte> runs = writer.take();
  BitReader many_runs(runs);
  EXPECT_FALSE(get_set(many_runs, 1ULL << 40U, 1U << 30U, back));
  writer.put_gamma(2);  // one run, from 0 on, of 2^39
  put_numbers(writer, Numbers{0});
  put_numbers(writer, Numbers{(1ULL << 39U) - 1});
  const std::vector<std::byte> length = writer.take();
  BitReader long_run(length);
  EXPECT_FALSE(get_set(long_run, 1ULL << 40U, 1000, back));
  EXPECT_TRUE(back.empty());
}

}  // namespace
}  // namespace occlod
