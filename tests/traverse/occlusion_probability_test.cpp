// The formulas of Guthe, Balazs and Klein 2006, by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "papers/trial_traverser.h"

namespace occlod::hlod {
namespace {

// 800 x 600 pixels at 90 degrees: the focal length is 300.
constexpr ImageScale image{300.0, 480'000.0, false};

// As printed: (1 / (d sqrt(w/h) 2 tan(theta/2)))^2 A_bb / 6 with d = 10, w/h = 4/3, tan = 1: a cube of edge 2 has a
// face of 4, so 4 / (100 * 4/3 * 4).
TEST(Coverage, OfACubeIsThatOfItsFace) {
  EXPECT_DOUBLE_EQ(box_coverage(24.0, 10.0, image), 4.0 / (100.0 * 4.0 / 3.0 * 4.0));
  EXPECT_DOUBLE_EQ(box_coverage(24.0, 10.0, image), 60.0 * 60.0 / 480'000.0);  // 2 * 300 / 10 pixels wide
  EXPECT_DOUBLE_EQ(box_coverage(24.0, 10.0, {30.0, 480'000.0, true}), 60.0 * 60.0 / 480'000.0);
}

TEST(Coverage, IsAtMostAll) {
  EXPECT_EQ(box_coverage(24.0, 0.01, image), 1.0);
  EXPECT_EQ(box_coverage(24.0, 0.0, image), 1.0);
  EXPECT_EQ(box_coverage(0.0, 0.0, image), 1.0);
  EXPECT_EQ(box_coverage(0.0, 1.0, image), 0.0);
}

// A ball in its cube covers pi r^2 of (2 r)^2: pi / 4.
TEST(Coverage, OfABallIsThatOfItsDisc) {
  const double pi = std::acos(-1.0);
  EXPECT_DOUBLE_EQ(coverage_ratio(4.0 * pi, 24.0), pi / 4.0);
  EXPECT_DOUBLE_EQ(mesh_coverage(0.5, 0.25), 0.125);
  EXPECT_DOUBLE_EQ(mesh_coverage(0.5, 3.0), 0.5);  // crumpled
  EXPECT_EQ(coverage_ratio(0.0, 0.0), 1.0);
}

TEST(Coverage, AddsUp) {
  EXPECT_DOUBLE_EQ(covered_with(0.0, 0.25), 0.25);
  EXPECT_DOUBLE_EQ(covered_with(0.25, 0.25), 0.25 + 0.75 * 0.25);
  EXPECT_DOUBLE_EQ(covered_with(1.0, 0.25), 1.0);
}

// The square roots of 0.81 and 0.25 are 0.9 and 0.5.
TEST(CoverProbability, IsByEdgesOfSquares) {
  EXPECT_NEAR(cover_probability(0.81, 0.25, CoverModel::printed), 0.16, 1e-15);
  EXPECT_NEAR(cover_probability(0.81, 0.25, CoverModel::corrected), 0.64, 1e-15);
  for (const CoverModel model : {CoverModel::printed, CoverModel::corrected}) {
    EXPECT_EQ(cover_probability(0.25, 0.25, model), 0.0);
    EXPECT_EQ(cover_probability(0.25, 0.81, model), 0.0);
    EXPECT_EQ(cover_probability(0.0, 0.0, model), 0.0);
    EXPECT_EQ(cover_probability(1.0, 1.0, model), 0.0);
    EXPECT_DOUBLE_EQ(cover_probability(0.5, 0.0, model), 0.5);  // of a point
  }
  // Behind what covers everything all is covered, which the printed form denies.
  EXPECT_DOUBLE_EQ(cover_probability(1.0, 0.25, CoverModel::corrected), 1.0);
  EXPECT_DOUBLE_EQ(cover_probability(1.0, 0.25, CoverModel::printed), 0.25);
}

// Squares in the unit square, both anywhere inside it; the smaller one must lie in the larger one.
TEST(CoverProbability, AsCorrectedIsThatOfSquaresInTheImage) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit;
  for (const auto& [covered, share] : {std::pair(0.8, 0.1), std::pair(0.6, 0.01), std::pair(0.95, 0.5)}) {
    const double large = std::sqrt(covered), small = std::sqrt(share);
    constexpr int count = 200'000;
    int inside = 0;
    for (int i = 0; i < count; ++i) {
      // The place of the larger one is anywhere between the margins, so the chance is that of the smaller one alone.
      const double x0 = (1.0 - large) * unit(random), y0 = (1.0 - large) * unit(random);
      const double x = (1.0 - small) * unit(random), y = (1.0 - small) * unit(random);
      inside += x >= x0 && x + small <= x0 + large && y >= y0 && y + small <= y0 + large ? 1 : 0;
    }
    // Four standard deviations.
    EXPECT_NEAR(static_cast<double>(inside) / count, cover_probability(covered, share, CoverModel::corrected),
                4.0 * std::sqrt(0.25 / count));
  }
}

TEST(OcclusionProbability, IsByTheLastFrame) {
  EXPECT_DOUBLE_EQ(occlusion_probability(0.5, LastSight::visible), 0.125);
  EXPECT_DOUBLE_EQ(occlusion_probability(0.5, LastSight::outside), 0.5);
  EXPECT_DOUBLE_EQ(occlusion_probability(0.5, LastSight::hidden), 1.0);
}

}  // namespace
}  // namespace occlod::hlod
