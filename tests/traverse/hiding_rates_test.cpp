#include <gtest/gtest.h>

#include "hlod/draw/query_value.h"

namespace occlod::hlod {
namespace {

// Before anybody has asked, the model decides; nothing is taken to stay visible for ever.
TEST(HidingRates, BeginWithTheModel) {
  const HidingRates rates;
  EXPECT_DOUBLE_EQ(rates.of_new(0.0), 0.0);
  EXPECT_DOUBLE_EQ(rates.of_new(0.8), 0.8);
  EXPECT_DOUBLE_EQ(rates.of_visible(0.8), 0.32);
  EXPECT_GT(rates.of_visible(0.0), 0.0);
}

// In the end answers decide: a tenth of those asked about after 5 frames makes a fiftieth a frame.
TEST(HidingRates, FollowAnswers) {
  HidingRates rates;
  for (int frame = 0; frame < 400; ++frame) {
    rates.begin_frame();
    for (int i = 0; i < 10; ++i) {
      rates.note_visible(0.5, 5.0, i == 0);
      rates.note_new(0.5, i < 7);
    }
  }
  EXPECT_NEAR(rates.of_visible(0.5), 0.02, 0.002);
  EXPECT_NEAR(rates.of_new(0.5), 0.7, 0.01);
  // Nodes of about the same probability share a rate, others do not.
  EXPECT_NEAR(rates.of_visible(0.6), rates.of_visible(0.5), 1e-3);
  EXPECT_DOUBLE_EQ(rates.of_new(0.9), 0.9);
  // What is long past is forgotten.
  for (int frame = 0; frame < 2000; ++frame) rates.begin_frame();
  EXPECT_NEAR(rates.of_new(0.5), 0.5, 1e-6);
}

TEST(HidingRates, TakeAnyProbability) {
  HidingRates rates;
  for (const double probability : {0.0, 1.0}) {
    rates.note_visible(probability, 0.0, true);
    rates.note_new(probability, true);
    EXPECT_GT(rates.of_visible(probability), 0.0);
    EXPECT_LE(rates.of_new(probability), 1.0);
  }
}

}  // namespace
}  // namespace occlod::hlod
