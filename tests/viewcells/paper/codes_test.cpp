// Lists of ids and their codes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "papers/adaptive_huffman.h"
#include "papers/delimiter_code.h"
#include "papers/id_lists.h"

namespace occlod::paper {
namespace {

using Numbers = std::vector<std::uint32_t>;

std::string text(const BitString& bits) {
  std::string result;
  for (std::size_t i = 0; i < bits.size(); ++i) result += bits[i] ? '1' : '0';
  return result;
}

// Numbers as gaps and lengths of runs are: mostly small, now and then large.
Numbers random_list(std::mt19937_64& random) {
  Numbers numbers(1 + random() % 12);
  for (std::uint32_t& n : numbers) {
    const double u = static_cast<double>(random() % 1'000'000 + 1) * 1e-6;
    n = static_cast<std::uint32_t>(std::min(std::pow(u, -1.0 / 0.7), 4.0e9));
  }
  return numbers;
}

// As printed both lists would be 101 + 11 + 11 -> 1011|11|110 and 10 + 11 + 1 + 11 + 10 -> 10|11|1|11|10: 101111110.
// With a lone 1 doubled the second has a bit more.
TEST(DelimiterCode, TellsListsApartThatArePrintedAlike) {
  EXPECT_EQ(text(encode_delimited(Numbers{5, 3})), "101111110");      // 1011 11 110
  EXPECT_EQ(text(encode_delimited(Numbers{2, 1, 2})), "1011111110");  // 10 11 11 11 10
  EXPECT_EQ(decode_delimited(encode_delimited(Numbers{5, 3})), (Numbers{5, 3}));
  EXPECT_EQ(decode_delimited(encode_delimited(Numbers{2, 1, 2})), (Numbers{2, 1, 2}));
}

// 11 for each, and 11 between them.
TEST(DelimiterCode, RepeatsOnes) {
  EXPECT_EQ(text(encode_delimited(Numbers{1, 1, 1})), "1111111111");
  EXPECT_EQ(decode_delimited(encode_delimited(Numbers{1, 1, 1})), (Numbers{1, 1, 1}));
}

// 7 = 111: the first pair becomes 110, so 1101, which ends in 01 and gets another 1. 13 = 1101 likewise: 11001, and
// a 1.
TEST(DelimiterCode, StuffsPairs) {
  EXPECT_EQ(text(encode_delimited(Numbers{7})), "11011");
  EXPECT_EQ(text(encode_delimited(Numbers{13})), "110011");
  EXPECT_TRUE(decode_delimited(encode_delimited(Numbers{})).empty());
}

TEST(DelimiterCode, ReadsBackAllShortLists) {
  for (std::uint32_t a = 1; a <= 20; ++a)
    for (std::uint32_t b = 1; b <= 20; ++b)
      for (std::uint32_t c = 1; c <= 20; ++c)
        for (const Numbers& list : {Numbers{a}, Numbers{a, b}, Numbers{a, b, c}, Numbers{a, 1, b, 1, 1, c}})
          ASSERT_EQ(decode_delimited(encode_delimited(list)), list);
}

TEST(DelimiterCode, ReadsBackRandomLists) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200'000; ++i) {
    const Numbers list = random_list(random);
    ASSERT_EQ(decode_delimited(encode_delimited(list)), list);
  }
}

TEST(AdaptiveHuffman, ReadsBackRandomLists) {
  std::mt19937_64 random(2);
  EXPECT_TRUE(decode_adaptive(encode_adaptive(Numbers{})).empty());
  for (int i = 0; i < 3000; ++i) {
    Numbers list;
    for (int k = 0; k < 1 + i % 20; ++k) {
      const Numbers more = random_list(random);
      list.insert(list.end(), more.begin(), more.end());
    }
    ASSERT_EQ(decode_adaptive(encode_adaptive(list)), list);
  }
}

// A Huffman code takes less than a bit more than the entropy; adapting costs little when the list is long. Numbers come
// with probabilities 1/2, 1/4, 1/8, 1/16, 1/16: 1.875 bits each, which a Huffman code reaches.
TEST(AdaptiveHuffman, ComesNearToTheEntropy) {
  std::mt19937_64 random(3);
  Numbers list(20'000);
  for (std::uint32_t& n : list) {
    n = 1;
    while (n < 5 && random() % 2 == 0) ++n;
  }
  const double bits = static_cast<double>(encode_adaptive(list).size()) / static_cast<double>(list.size());
  EXPECT_GT(bits, 1.83);  // of this list, whose shares differ a little
  EXPECT_LT(bits, 1.95);
}

TEST(IdLists, RunsAreGapsAndLengths) {
  // From before 0 to 2 are 3 steps; 2, 3, 4 end before 5; from there to 9.
  EXPECT_EQ(runs_of(Numbers{2, 3, 4, 9}), (Numbers{3, 3, 5, 1}));
  EXPECT_EQ(runs_of(Numbers{0}), (Numbers{1, 1}));
  EXPECT_EQ(gaps_of(Numbers{2, 3, 4, 9}), (Numbers{3, 1, 1, 5}));
  EXPECT_TRUE(runs_of(Numbers{}).empty());
}

Numbers random_ids(std::mt19937_64& random, double share) {
  Numbers ids;
  for (std::uint32_t id = 0; id < 300; ++id)
    if (static_cast<double>(random() % 1000) < 1000 * share) ids.push_back(id);
  return ids;
}

TEST(IdLists, AreFoundAgain) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 500; ++i) {
    const Numbers a = random_ids(random, 0.1 * (i % 11)), b = random_ids(random, 0.1 * (i % 7));
    const Delta d = delta(a, b);
    EXPECT_EQ(with_delta(d, a), b);
    EXPECT_EQ(with_delta(Delta{d.removed, d.added}, b), a);
    EXPECT_EQ(ids_of_runs(runs_of(a)), a);
    const Numbers runs = runs_of(a), gaps = gaps_of(a);
    EXPECT_TRUE(std::all_of(runs.begin(), runs.end(), [](std::uint32_t n) { return n >= 1; }));
    EXPECT_EQ(std::accumulate(gaps.begin(), gaps.end(), 0U), a.empty() ? 0U : a.back() + 1);
  }
}

TEST(IdLists, OfOneCellAreNoDelta) {
  EXPECT_EQ(delta(Numbers{1, 5}, Numbers{1, 5}), Delta{});
  EXPECT_EQ(delta(Numbers{1, 5}, Numbers{5, 7}), (Delta{{7}, {1}}));
}

}  // namespace
}  // namespace occlod::paper
