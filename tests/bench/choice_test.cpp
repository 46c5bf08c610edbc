// Which settings are on the front and which is chosen, on costs whose order can be seen.
#include "report/choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace occlod::bench {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

using Places = std::vector<std::size_t>;

TEST(ParetoFront, HoldsWhatNothingBeats) {
  // By time: 3 (1 ms), 0 (2 ms), 4 (2 ms, worse than 0), 1 (3 ms, as bad as 0), 2 (4 ms).
  const std::vector<Cost> costs = {{2, 5}, {3, 5}, {4, 1}, {1, 9}, {2, 6}};
  EXPECT_EQ(pareto_front(costs), (Places{3, 0, 2}));
}

TEST(ParetoFront, OfEqualOnesTheFirst) {
  const std::vector<Cost> costs = {{2, 5}, {2, 5}};
  EXPECT_EQ(pareto_front(costs), Places{0});
}

TEST(ParetoFront, LeavesOutWhatIsNoNumber) {
  const std::vector<Cost> costs = {{1, unlimited}, {1, std::nan("")}, {2, 7}};
  EXPECT_EQ(pareto_front(costs), Places{2});
}

TEST(FastestWithin, IsTheFirstOfTheFrontThatIsAccurateEnough) {
  const std::vector<Cost> costs = {{1, 9}, {2, 5}, {3, 6}, {4, 1}};
  EXPECT_EQ(fastest_within(costs, 9.0), std::optional<std::size_t>(0));
  EXPECT_EQ(fastest_within(costs, 6.0), std::optional<std::size_t>(1));  // not 2: slower
  EXPECT_EQ(fastest_within(costs, 4.9), std::optional<std::size_t>(3));
  EXPECT_EQ(fastest_within(costs, 0.9), std::nullopt);
}

}  // namespace
}  // namespace occlod::bench
