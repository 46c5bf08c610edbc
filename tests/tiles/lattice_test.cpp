#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <random>
#include <vector>

#include "hlod/tiles/encode_tile.h"

namespace occlod::tiles {
namespace {

std::vector<glm::vec3> random_points(std::uint64_t seed, const glm::vec3& center, float extent) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> within(-extent / 2.0F, extent / 2.0F);
  std::vector<glm::vec3> points;
  for (int i = 0; i < 200; ++i) points.push_back(center + glm::vec3(within(random), within(random), within(random)));
  return points;
}

// Sterbenz's argument: see near_origin().
TEST(NearOrigin, DifferencesAreExact) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const float extent = std::exp2(static_cast<float>(seed % 40) - 20.0F);
    const glm::vec3 center(static_cast<float>(seed % 7), -3e5F,
                           std::exp2(static_cast<float>(seed % 11)) * extent / 8.0F);
    const std::vector<glm::vec3> points = random_points(seed, center, extent);
    const glm::dvec3 origin = near_origin(points);
    for (const glm::vec3& p : points) {
      const glm::vec3 from_origin(glm::dvec3(p) - origin);
      EXPECT_EQ(glm::dvec3(from_origin) + origin, glm::dvec3(p));
      // No worse than three times from the middle.
      EXPECT_LE(glm::length(from_origin), 3.0F * std::sqrt(3.0F) * extent);
    }
  }
}

TEST(TileLattice, NearestPointsOfThatManyBits) {
  for (const int bits : {8, 13, 16}) {
    const std::vector<glm::vec3> points = random_points(3, {1000.0F, -20.0F, 0.1F}, 7.0F);
    const TileLattice lattice(points, bits);
    EXPECT_EQ(std::exp2(std::round(std::log2(lattice.step()))), lattice.step());
    // The finest: half the step would need more than so many bits.
    EXPECT_GT(7.0 / (lattice.step() / 2.0), std::exp2(bits) - 3.0);
    glm::u16vec3 most(0), least(65535);
    for (const glm::vec3& p : points) {
      const glm::u16vec3 at = lattice.at(p);
      const glm::dvec3 error = glm::abs(lattice.position(at) - glm::dvec3(p));
      EXPECT_LE(std::max({error.x, error.y, error.z}), lattice.step() / 2.0);
      most = glm::max(most, at);
      least = glm::min(least, at);
    }
    EXPECT_EQ(least, glm::u16vec3(0));
    EXPECT_EQ(most, lattice.far_end());
    EXPECT_LT(std::max({most.x, most.y, most.z}), 1 << bits);
  }
}

// Two tiles of one size beside each other: what they share stays shared.
TEST(TileLattice, NeighboursRoundToTheSamePlace) {
  std::vector<glm::vec3> left = random_points(5, {0.0F, 0.0F, 0.0F}, 0.8F);
  std::vector<glm::vec3> right = random_points(6, {0.7F, 0.1F, 0.2F}, 0.8F);
  const std::vector<glm::vec3> shared = random_points(7, {0.35F, 0.05F, 0.1F}, 0.05F);
  left.insert(left.end(), shared.begin(), shared.end());
  right.insert(right.end(), shared.begin(), shared.end());
  const TileLattice a(left, 12), b(right, 12);
  ASSERT_EQ(a.step(), b.step());
  for (const glm::vec3& p : shared) EXPECT_EQ(a.position(a.at(p)), b.position(b.at(p)));
}

TEST(TileLattice, AnySize) {
  const std::vector<std::vector<glm::vec3>> hard = {{{1e37F, 0, 0}, {-1e37F, 1, 2}},
                                                    {{1e-45F, 0, 0}, {0, 2e-45F, 0}},
                                                    {{3, 4, 5}, {3, 4, 5}},
                                                    {{0, 0, 0}, {0, 0, 0}},
                                                    {{1e37F, 1, 1}, {1e37F, 1, 1.5F}}};
  for (const std::vector<glm::vec3>& points : hard) {
    const TileLattice lattice(points, 16);
    EXPECT_TRUE(std::isfinite(lattice.step()) && lattice.step() > 0.0);
    for (const glm::vec3& p : points) {
      const glm::dvec3 error = glm::abs(lattice.position(lattice.at(p)) - glm::dvec3(p));
      EXPECT_LE(std::max({error.x, error.y, error.z}), lattice.step() / 2.0);
    }
  }
}

}  // namespace
}  // namespace occlod::tiles
