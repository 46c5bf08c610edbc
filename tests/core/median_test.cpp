#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "base/timing.h"

namespace occlod {
namespace {

TEST(Median, IsTheMiddleInWhateverOrder) {
  std::vector<int> values = {1, 2, 4, 8, 16};
  do EXPECT_EQ(median(values), 4);
  while (std::next_permutation(values.begin(), values.end()));
}

TEST(Median, OfAnEvenNumberIsTheLargerOfTheTwo) {
  EXPECT_EQ(median(std::vector<double>{3.0, 1.0}), 3.0);
  EXPECT_EQ(median(std::vector<double>{4.0, 1.0, 3.0, 2.0}), 3.0);
}

TEST(Median, OfEqualValuesAndOfOneIsThatValue) {
  EXPECT_EQ(median(std::vector<float>{0.25F}), 0.25F);
  EXPECT_EQ(median(std::vector<float>{7.0F, 7.0F, 7.0F, -1.0F}), 7.0F);
}

TEST(Median, LeavesTheValuesOfItsCallerAlone) {
  std::vector<int> values(101);
  std::iota(values.rbegin(), values.rend(), 0);
  const std::vector<int> before = values;
  EXPECT_EQ(median(values), 50);
  EXPECT_EQ(values, before);
}

}  // namespace
}  // namespace occlod
