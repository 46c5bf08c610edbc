#include "occlod/bounds.h"

#include <gtest/gtest.h>

#include <array>
#include <glm/geometric.hpp>
#include <random>

namespace occlod {
namespace {

glm::vec3 random_unit(std::mt19937& random) {
  std::normal_distribution<float> normal;
  glm::vec3 v;
  do v = {normal(random), normal(random), normal(random)};
  while (glm::length(v) < 1e-3F);
  return glm::normalize(v);
}

TEST(Bounds, BoxHoldsItsPointsAndNoMore) {
  const std::array<glm::vec3, 3> points = {{{1, -2, 3}, {-1, 5, 0}, {0, 0, 4}}};
  const Box box = bounding_box(points);
  EXPECT_EQ(box.min, glm::vec3(-1, -2, 0));
  EXPECT_EQ(box.max, glm::vec3(1, 5, 4));
  EXPECT_EQ(corner(box, 0), box.min);
  EXPECT_EQ(corner(box, 7), box.max);
  EXPECT_EQ(corner(box, 1), glm::vec3(1, -2, 0));  // bit 0 is x
}

// True iff a face with normal n through p shows its front to the eye.
bool front(const glm::vec3& n, const glm::vec3& p, const glm::vec3& eye) { return glm::dot(n, eye - p) > 0.0F; }

glm::vec3 random_in_cone(const NormalCone& cone, std::mt19937& random) {
  glm::vec3 n;
  do n = random_unit(random);
  while (glm::dot(n, cone.axis) < cone.cos_angle);
  return n;
}

TEST(FacesAway, NeverForASurfaceOfWhichAFrontIsSeen) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  int culled = 0;
  for (int n = 0; n < 3000; ++n) {
    const Sphere sphere{random_unit(random), unit(random)};
    const NormalCone cone{random_unit(random), 0.3F + 0.69F * unit(random)};
    const glm::vec3 eye = random_unit(random) * (4.0F * unit(random));
    if (!faces_away(cone, sphere, eye)) continue;
    ++culled;
    for (int k = 0; k < 50; ++k) {
      const glm::vec3 p = sphere.center + random_unit(random) * sphere.radius * unit(random);
      ASSERT_FALSE(front(random_in_cone(cone, random), p, eye));
    }
  }
  EXPECT_GT(culled, 100);
}

TEST(FacesAway, WhenTheNearestTiltStillPointsAway) {
  // Eye at +z, cone around -z with half angle a, points within r of the origin: the worst face is tilted by a towards
  // the eye and r nearer to it, so the cone faces away iff distance * cos(a) > r.
  const NormalCone cone{{0, 0, -1}, 0.8F};
  const Sphere sphere{{0, 0, 0}, 1.0F};
  EXPECT_TRUE(faces_away(cone, sphere, {0, 0, 1.26F}));                   // 1.26 * 0.8 > 1
  EXPECT_FALSE(faces_away(cone, sphere, {0, 0, 1.24F}));                  // 1.24 * 0.8 < 1
  EXPECT_FALSE(faces_away(cone, sphere, {0, 0, -5.0F}));                  // seen from the front
  EXPECT_FALSE(faces_away({{0, 0, -1}, -1.0F}, sphere, {0, 0, 100.0F}));  // no cone
}

}  // namespace
}  // namespace occlod
