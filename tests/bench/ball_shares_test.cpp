#include "support/ball_shares.h"

#include <gtest/gtest.h>

#include <array>

namespace occlod::bench {
namespace {

// Column i has ones in the first i rows: |i - j| rows tell columns i and j apart.
TEST(BallShares, OfColumnsInARow) {
  const paper::BitColumns columns({{}, {0}, {0, 1}, {0, 1, 2}, {0, 1, 2, 3}});
  const BallShares shares = ball_shares(columns, std::array{1.0, 2.0, 3.9}, 100);
  EXPECT_EQ(shares.centres, 5U);
  EXPECT_EQ(shares.equal_share, 0.0);
  // The nearest is at distance 1 from all. Within 1: 1, 2, 2, 2 and 1 of the four others; within 2: 2, 3, 4, 3, 2;
  // within 3.9, that is 3: 3, 4, 4, 4, 3.
  EXPECT_DOUBLE_EQ(shares.mean[0], 8.0 / 20.0);
  EXPECT_DOUBLE_EQ(shares.mean[1], 14.0 / 20.0);
  EXPECT_DOUBLE_EQ(shares.mean[2], 18.0 / 20.0);
  EXPECT_DOUBLE_EQ(shares.least[0], 1.0 / 4.0);
  EXPECT_DOUBLE_EQ(shares.least[1], 2.0 / 4.0);
  EXPECT_DOUBLE_EQ(shares.least[2], 3.0 / 4.0);
}

// The nearest is the nearest that differs; what is equal is in the ball.
TEST(BallShares, OfEqualColumns) {
  const BallShares shares = ball_shares(paper::BitColumns({{1}, {1}, {2}, {5, 6, 7}}), std::array{1.0}, 100);
  EXPECT_EQ(shares.centres, 4U);
  EXPECT_DOUBLE_EQ(shares.equal_share, 0.5);
  // From the first two: each other, and {2} at 2; from {2}: both at 2; from the last, at 4 from all, all three.
  EXPECT_DOUBLE_EQ(shares.mean[0], (2.0 + 2.0 + 2.0 + 3.0) / 12.0);
  EXPECT_EQ(ball_shares(paper::BitColumns({{3}, {3}}), std::array{1.0}, 100).centres, 0U);
}

TEST(BallShares, LooksFromSomeOnly) {
  const paper::BitColumns columns({{}, {0}, {0, 1}, {0, 1, 2}, {0, 1, 2, 3}});
  const BallShares shares = ball_shares(columns, std::array{1.0}, 2);  // from the columns 0 and 2
  EXPECT_EQ(shares.centres, 2U);
  EXPECT_DOUBLE_EQ(shares.mean[0], 3.0 / 8.0);
}

}  // namespace
}  // namespace occlod::bench
