// The test that decides whether to ask: Guthe, Balazs and Klein 2006, fig. 5, line by line.
#include "hlod/draw/query_value.h"

#include <gtest/gtest.h>

namespace occlod::hlod {
namespace {

// Draws: 100 each, 1 a triangle, 0.5 a fragment. Queries: 40, 0.25 a fragment, 20 beside a draw.
const DeviceCosts costs{.name = "test",
                        .draw_ns = 100.0,
                        .triangle_ns = 1.0,
                        .fragment_ns = 0.5,
                        .query_ns = 40.0,
                        .query_fragment_ns = 0.25,
                        .wrapped_query_ns = 20.0,
                        .readback_ns = 500.0};

TEST(Times, AreThoseOfTheSlowestStage) {
  EXPECT_EQ(draw_time_ns(costs, {1.0, 10.0, 10.0}), 100.0);
  EXPECT_EQ(draw_time_ns(costs, {1.0, 2000.0, 10.0}), 2000.0);
  EXPECT_EQ(draw_time_ns(costs, {1.0, 2000.0, 6000.0}), 3000.0);
  DrawWork two{1.0, 10.0, 300.0};
  two += {2.0, 20.0, 500.0};  // in each stage what both take: 300, 30, 400
  EXPECT_EQ(draw_time_ns(costs, two), 400.0);
  EXPECT_EQ(draw_time_ns(costs, 0.5 * two), 200.0);
  EXPECT_EQ(query_time_ns(costs, 100.0), 40.0);
  EXPECT_EQ(query_time_ns(costs, 400.0), 100.0);
}

TEST(Times, BenefitIsSpreadOverTheLevels) { EXPECT_EQ(query_value(140.0, 40.0, 0.5, 10.0).benefit_ns, 5.0); }

// (40 + 500) / min(40, 20 + 100) = 13.5, rounded up, and one more.
TEST(Times, LimitQueriesUnderWay) { EXPECT_EQ(max_parallel_queries(costs), 15.0); }

class Reasonable : public ::testing::Test {
 protected:
  [[nodiscard]] bool leaf() const { return is_query_reasonable(costs, node_, before_, nullptr); }
  [[nodiscard]] bool inner() const { return is_query_reasonable(costs, node_, before_, &children_); }

  QueryValue node_{200.0, 40.0, 10.0};  // drawn, asked, benefit
  AskedBefore before_{LastSight::visible, 0.5, 4.0};
  ChildrenValue children_{60.0, 5.0, 3.0, false};
};

TEST_F(Reasonable, NotWhereDrawingIsCheaper) {
  before_.last = LastSight::hidden;
  EXPECT_TRUE(leaf());
  node_.draw_ns = 39.0;
  EXPECT_FALSE(leaf());
}

TEST_F(Reasonable, NotWhereAskingTheChildrenIsCheaper) {
  before_.last = LastSight::hidden;
  EXPECT_TRUE(inner());
  children_.query_ns = 39.0;
  EXPECT_FALSE(inner());
}

TEST_F(Reasonable, AfterTheWaitHasPaidForIt) {
  EXPECT_TRUE(leaf());  // 40 <= 4 * 10
  before_.frames_since_asked = 3.0;
  EXPECT_FALSE(leaf());
  before_.last = LastSight::hidden;  // always
  EXPECT_TRUE(leaf());
}

// 40 + (1 - p) 200 < 200 from p = 0.2 on.
TEST_F(Reasonable, OfWhatComesIntoTheFrustumWhereItPaysAtOnce) {
  before_ = {LastSight::outside, 0.21, 0.0};
  EXPECT_TRUE(leaf());
  EXPECT_TRUE(inner());
  before_.occlusion_probability = 0.19;
  EXPECT_FALSE(leaf());
}

TEST_F(Reasonable, WhereTheNodeGainsMoreThanItsChildren) {
  EXPECT_TRUE(inner());  // 10 > 5 and 3 * 20 > 40
  children_.benefit_ns = 10.0;
  EXPECT_FALSE(inner());
}

TEST_F(Reasonable, NotWhereAskingWhileDrawingIsCheaper) {
  children_.leaves = 2.0;  // 2 * 20 is not more than 40
  EXPECT_FALSE(inner());
}

TEST_F(Reasonable, OnTheLastLevelOnWhichAllCanBeAsked) {
  children_ = {60.0, 100.0, 1.0, true};
  EXPECT_TRUE(inner());
}

}  // namespace
}  // namespace occlod::hlod
