// Tours through columns of bits, beside all permutations.
#include "papers/hamming_tour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace occlod::paper {
namespace {

using Rows = std::vector<std::vector<std::uint32_t>>;

Rows random_rows(std::mt19937_64& random, std::uint32_t columns, std::uint32_t rows, unsigned percent) {
  Rows result(columns);
  for (auto& column : result)
    for (std::uint32_t row = 0; row < rows; ++row)
      if (random() % 100 < percent) column.push_back(row);
  return result;
}

Order identity(std::uint32_t n) {
  Order order(n);
  std::iota(order.begin(), order.end(), 0U);
  return order;
}

bool is_permutation(Order order) {
  std::sort(order.begin(), order.end());
  return order == identity(static_cast<std::uint32_t>(order.size()));
}

// One row after the other, without distances.
std::size_t count_runs_by_rows(const Rows& columns, const Order& order, std::uint32_t rows) {
  std::size_t runs = 0;
  for (std::uint32_t row = 0; row < rows; ++row) {
    bool before = false;
    for (const std::uint32_t c : order) {
      const bool now = std::find(columns[c].begin(), columns[c].end(), row) != columns[c].end();
      runs += now && !before ? 1 : 0;
      before = now;
    }
  }
  return runs;
}

std::size_t fewest_runs(const BitColumns& columns) {
  Order order = identity(columns.size());
  std::size_t fewest = count_runs(columns, order);
  while (std::next_permutation(order.begin(), order.end())) fewest = std::min(fewest, count_runs(columns, order));
  return fewest;
}

// 0110: from 0 to 1 and back twice; the paper's example 0011100111010 has three runs.
TEST(HammingTour, CountsRuns) {
  const Rows example = {{}, {}, {0}, {0}, {0}, {}, {}, {0}, {0}, {0}, {}, {0}, {}};
  EXPECT_EQ(count_runs(BitColumns(example), identity(13)), 3U);
  const BitColumns two({{0, 2, 5}, {0, 3, 5}});
  EXPECT_EQ(two.distance(0, 1), 2U);
  EXPECT_EQ(two.distance(0, 0), 0U);
  std::mt19937_64 random(1);
  for (int i = 0; i < 100; ++i) {
    const Rows rows = random_rows(random, 9, 20, 30);
    Order order = identity(9);
    std::shuffle(order.begin(), order.end(), random);
    EXPECT_EQ(count_runs(BitColumns(rows), order), count_runs_by_rows(rows, order, 20));
  }
}

TEST(HammingTour, FindsTheNearest) {
  std::mt19937_64 random(2);
  const BitColumns columns(random_rows(random, 60, 40, 20));
  const Neighbours near = nearest_columns(columns, 5);
  for (std::uint32_t c = 0; c < columns.size(); ++c) {
    ASSERT_EQ(near.of[c].size(), 5U);
    const std::uint32_t farthest = columns.distance(c, near.of[c].back());
    for (std::uint32_t other = 0; other < columns.size(); ++other) {
      const bool listed = std::find(near.of[c].begin(), near.of[c].end(), other) != near.of[c].end();
      EXPECT_TRUE(other == c || listed || columns.distance(c, other) >= farthest);
    }
    EXPECT_EQ(std::count(near.of[c].begin(), near.of[c].end(), c), 0);
  }
}

TEST(HammingTour, TakesNeighboursFromOneSample) {
  std::mt19937_64 random(3);
  const BitColumns columns(random_rows(random, 60, 40, 20));
  const std::vector<std::uint32_t> sample = sample_columns(columns, 12, 7);
  ASSERT_EQ(sample.size(), 12U);
  EXPECT_EQ(std::adjacent_find(sample.begin(), sample.end(), std::greater_equal<>()), sample.end());
  const Neighbours near = nearest_of_sample(columns, 5, sample);
  for (std::uint32_t c = 0; c < columns.size(); ++c)
    for (const std::uint32_t n : near.of[c]) EXPECT_TRUE(std::binary_search(sample.begin(), sample.end(), n));
  EXPECT_EQ(sample_columns(columns, 100, 7).size(), 60U);
}

// With all columns as neighbours the tour is never better than the best of all permutations, and mostly as good.
TEST(HammingTour, IsMostlyTheShortestOfEightColumns) {
  std::mt19937_64 random(4);
  int best = 0;
  constexpr int cases = 100;
  for (int i = 0; i < cases; ++i) {
    const BitColumns columns(random_rows(random, 8, 6 + static_cast<std::uint32_t>(i) % 20, 30));
    const Neighbours near = nearest_columns(columns, 8);
    Order order = greedy_tour(columns, near);
    ASSERT_TRUE(is_permutation(order));
    const std::size_t seed = count_runs(columns, order);
    const Improvement improved = improve_tour(columns, near, order, 1000);
    ASSERT_TRUE(is_permutation(order));
    EXPECT_EQ(count_runs(columns, order), improved.runs);
    EXPECT_LE(improved.runs, seed);
    const std::size_t fewest = fewest_runs(columns);
    EXPECT_GE(improved.runs, fewest);
    best += improved.runs == fewest ? 1 : 0;
  }
  EXPECT_GE(best, 3 * cases / 4);
}

// Rows that are single runs in some order: then so many runs as rows with ones are left, or few more.
TEST(HammingTour, FindsConsecutiveOnes) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 20; ++i) {
    constexpr std::uint32_t n = 200, rows = 60;
    Order hidden = identity(n);
    std::shuffle(hidden.begin(), hidden.end(), random);
    Rows columns(n);
    for (std::uint32_t row = 0; row < rows; ++row) {
      const std::uint32_t from = static_cast<std::uint32_t>(random() % (n - 30));
      for (std::uint32_t place = from; place < from + 5 + random() % 25; ++place) columns[hidden[place]].push_back(row);
    }
    const BitColumns bits(columns);
    const Neighbours near = nearest_columns(bits, 20);
    Order order = greedy_tour(bits, near);
    const Improvement improved = improve_tour(bits, near, order, 100'000);
    EXPECT_TRUE(is_permutation(order));
    EXPECT_GE(improved.runs, rows);
    EXPECT_LE(improved.runs, rows + rows / 5);
    EXPECT_GT(count_runs(bits, identity(n)), 4 * improved.runs);
  }
}

TEST(HammingTour, StopsAfterSoManyMoves) {
  std::mt19937_64 random(6);
  const BitColumns columns(random_rows(random, 100, 50, 20));
  const Neighbours near = nearest_columns(columns, 20);
  Order one = identity(100), more = one;
  EXPECT_EQ(improve_tour(columns, near, one, 1).moves, 1U);
  const Improvement improved = improve_tour(columns, near, more, 100'000);
  EXPECT_GT(improved.moves, 10U);
  EXPECT_LT(improved.runs, count_runs(columns, one));
  Order again = more;
  EXPECT_EQ(improve_tour(columns, near, again, 100'000).moves, 0U);  // none helps any more
}

TEST(HammingTour, OfNothing) {
  const BitColumns none({});
  EXPECT_TRUE(greedy_tour(none, nearest_columns(none, 20)).empty());
  EXPECT_EQ(count_runs(none, {}), 0U);
}

}  // namespace
}  // namespace occlod::paper
