// How many pictures become one number.
#include "report/measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace occlod::bench {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

double mean(Mean kind, const std::vector<double>& values) { return mean_of(kind, values); }

TEST(MeanOf, OnePictureIsItsOwnNumber) {
  for (const Mean kind : {Mean::arithmetic, Mean::square, Mean::decibel, Mean::middle})
    EXPECT_NEAR(mean(kind, {37.5}), 37.5, 1e-12);
}

TEST(MeanOf, WorksOnWhatTheMeasureSays) {
  EXPECT_NEAR(mean(Mean::arithmetic, {1, 7}), 4.0, 1e-12);
  EXPECT_NEAR(mean(Mean::square, {1, 7}), 5.0, 1e-12);  // the root of 50 / 2
  EXPECT_EQ(mean(Mean::middle, {9, 1, 2}), 2.0);
  // Errors of 10 dB and nothing at all: half the power is 3.01 dB more.
  EXPECT_NEAR(mean(Mean::decibel, {10, unlimited}), 10.0 + 10.0 * std::log10(2.0), 1e-12);
}

TEST(MeanOf, PassesOverWhatWasNotMeasured) {
  const double nothing = std::nan("");
  EXPECT_EQ(mean(Mean::arithmetic, {nothing, 3}), 3.0);
  EXPECT_TRUE(std::isnan(mean(Mean::arithmetic, {nothing, nothing})));
  EXPECT_EQ(mean(Mean::decibel, {unlimited, unlimited}), unlimited);
}

TEST(MeanOf, PicturesMeasureByMeasure) {
  Measured one{}, other{};
  one[main_measure] = 1.0;
  other[main_measure] = 7.0;
  one[wrongly_hidden_measure] = 2.0;
  const std::vector<Measured> pictures = {one, other};
  EXPECT_NEAR(mean_of(pictures)[main_measure], 5.0, 1e-12);
  EXPECT_NEAR(mean_of(pictures)[wrongly_hidden_measure], 1.0, 1e-12);
}

}  // namespace
}  // namespace occlod::bench
