#include <gtest/gtest.h>

#include <cmath>
#include <glm/vec3.hpp>
#include <random>

#include "occlod/mesh.h"

namespace occlod {
namespace {

Box box(const glm::vec3& min, const glm::vec3& max) { return {min, max}; }

TEST(LatticeStep, IsTheLeastPowerOfTwoThatIsEnough) {
  EXPECT_EQ(lattice_step(box(glm::vec3(0.0F), glm::vec3(1.0F, 2.0F, 4.0F)), 10), 1.0F / 256.0F);
  EXPECT_EQ(lattice_step(box(glm::vec3(0.0F), glm::vec3(1.0F, 2.0F, 4.001F)), 10), 1.0F / 128.0F);
  EXPECT_EQ(lattice_step(box(glm::vec3(-3.0F), glm::vec3(0.0F)), 1), 2.0F);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> at(-100.0F, 100.0F);
  for (int i = 0; i < 1000; ++i) {
    const float a = at(random), b = at(random);
    const int bits = 1 + i % 20;
    const double extent = std::abs(double{a} - double{b});
    const double step = lattice_step(box(glm::vec3(std::min(a, b)), glm::vec3(std::max(a, b))), bits);
    int exponent = 0;
    EXPECT_EQ(std::frexp(step, &exponent), 0.5) << "a power of two";
    EXPECT_LE(extent, std::ldexp(step, bits));
    const double of_floats = std::ldexp(1.0, std::ilogb(std::max(std::abs(a), std::abs(b))) - 23);
    EXPECT_TRUE(step == of_floats || extent > std::ldexp(step / 2, bits));
  }
}

TEST(LatticeStep, IsNoFinerThanFloats) {
  EXPECT_EQ(lattice_step(box(glm::vec3(6e6F), glm::vec3(6e6F + 100.0F)), 23), 0.5F);
  EXPECT_EQ(lattice_step(box(glm::vec3(-6e6F - 100.0F), glm::vec3(-6e6F)), 23), 0.5F);
  EXPECT_GT(lattice_step(box(glm::vec3(0.0F), glm::vec3(1e-38F)), 23), 0.0F);
}

TEST(LatticeStep, IsNoneWithoutExtent) { EXPECT_EQ(lattice_step(box(glm::vec3(7.0F), glm::vec3(7.0F)), 12), 0.0F); }

TEST(RoundToLattice, MovesByHalfAStepAtMost) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> at(-50.0F, 50.0F);
  const float step = lattice_step(box(glm::vec3(-50.0F), glm::vec3(50.0F)), 12);
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 p(at(random), at(random), at(random));
    const glm::vec3 rounded = round_to_lattice(p, step);
    EXPECT_EQ(round_to_lattice(rounded, step), rounded);
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(std::abs(double{rounded[k]} - double{p[k]}), step / 2.0);
      EXPECT_EQ(std::fmod(rounded[k], step), 0.0F);
    }
  }
}

TEST(RoundToLattice, TiesGoToEvenMultiplesAndZeroIsPositive) {
  EXPECT_EQ(round_to_lattice({0.5F, 1.5F, -2.5F}, 1.0F), glm::vec3(0.0F, 2.0F, -2.0F));
  const glm::vec3 zero = round_to_lattice({-0.0F, -0.25F, 0.25F}, 1.0F);
  for (int k = 0; k < 3; ++k) EXPECT_FALSE(std::signbit(zero[k]));
  const glm::vec3 kept = round_to_lattice({0.3F, -0.0F, 7e20F}, 0.0F);
  EXPECT_EQ(kept, glm::vec3(0.3F, 0.0F, 7e20F)) << "there is no lattice";
}

}  // namespace
}  // namespace occlod
