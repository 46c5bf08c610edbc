// Packed bounds may only grow: whatever was inside before packing is inside after unpacking.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "occlod/hierarchy.h"
#include "splits/packed_bounds.h"

namespace occlod {
namespace {

std::mt19937 random_numbers(11);
float uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_numbers); }
glm::vec3 direction() {
  for (;;) {
    const glm::vec3 v(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    if (const float length = glm::length(v); length > 0.01F && length <= 1.0F) return v / length;
  }
}

TEST(PackedBounds, AxisIsUnitAndNear) {
  // 65535 steps over each octant pair: neighbours are less than 1e-4 apart.
  PackedBounds bounds;
  const auto check = [&](const glm::vec3& n) {
    bounds.set_axis(n);
    const glm::vec3 unpacked = bounds.unpack_axis();
    EXPECT_NEAR(glm::length(unpacked), 1.0F, 3e-7F);
    EXPECT_LT(glm::distance(unpacked, n), 1e-4F);
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {1.0F, -1.0F}) {
      glm::vec3 n(0.0F);
      n[axis] = sign;
      check(n);
    }
  for (int i = 0; i < 2000; ++i) check(direction());
}

TEST(PackedBounds, ConeOnlyWidens) {
  PackedBounds bounds;
  bounds.set_axis({0, 0, 1});
  for (const float cos : {-1.0F, 0.0F, std::nanf("")}) {
    bounds.set_cone(cos);
    EXPECT_FALSE(bounds.cone().culls());
  }
  for (const float cos : {1e-6F, 0.3F, 0.5F, 0.99999F, 1.0F}) {
    bounds.set_cone(cos);
    EXPECT_LE(bounds.cone().cos_angle, cos);
    if (cos > 1e-4F) {
      EXPECT_GT(bounds.cone().cos_angle, cos - 2.0F / 65535.0F);
    }
  }
}

// Boxes and cylinders inside spheres of all sizes, near and far from the origin.
TEST(PackedBounds, BoxAndCylinderOnlyGrow) {
  for (int i = 0; i < 20'000; ++i) {
    const float size = std::pow(10.0F, uniform(-12, 12));
    Sphere sphere{size * uniform(0, 100) * direction(), 0.0F};
    Box box{sphere.center, sphere.center};
    for (int k = 0; k < 3; ++k) {
      box.min[k] -= size * uniform(0, 1);
      box.max[k] += size * uniform(0, 1);
    }
    // The smallest float that is no less than any exact distance from the center.
    double radius = 0.0;
    for (int k = 0; k < 8; ++k)
      radius = std::max(radius, glm::distance(glm::dvec3(sphere.center), glm::dvec3(corner(box, k))));
    sphere.radius = std::nextafter(static_cast<float>(radius), HUGE_VALF);
    const float r = sphere.radius;
    const Cylinder cylinder{sphere.center, r * uniform(0, 1), {0, 0, 1}, -r * uniform(0, 1), r * uniform(0, 1)};
    PackedBounds bounds;
    bounds.set_box(sphere, box);
    bounds.set_cylinder(sphere, cylinder);
    const Box b = bounds.box(sphere);
    const Cylinder c = bounds.cylinder(sphere);
    const double step = 2.0 * static_cast<double>(r) / 65535.0;
    for (int k = 0; k < 3; ++k) {
      ASSERT_LE(b.min[k], box.min[k]);
      ASSERT_GE(b.max[k], box.max[k]);
      const double rounding = 1e-6 * std::abs(static_cast<double>(sphere.center[k]));
      ASSERT_GE(static_cast<double>(b.min[k]), static_cast<double>(box.min[k]) - 2.0 * step - rounding);
      ASSERT_LE(static_cast<double>(b.max[k]), static_cast<double>(box.max[k]) + 2.0 * step + rounding);
    }
    ASSERT_GE(c.radius, cylinder.radius);
    ASSERT_LE(c.t_min, cylinder.t_min);
    ASSERT_GE(c.t_max, cylinder.t_max);
    ASSERT_LE(static_cast<double>(c.radius - cylinder.radius), 2.0 * step);
    ASSERT_LE(static_cast<double>(cylinder.t_min - c.t_min), 2.0 * step);
    ASSERT_LE(static_cast<double>(c.t_max - cylinder.t_max), 2.0 * step);
  }
}

TEST(PackedBounds, PointsHaveBounds) {
  const Sphere sphere{{3, 4, 5}, 0.0F};
  PackedBounds bounds;
  bounds.set_box(sphere, {sphere.center, sphere.center});
  bounds.set_cylinder(sphere, {sphere.center, 0.0F, {0, 0, 1}, 0.0F, 0.0F});
  EXPECT_EQ(bounds.box(sphere).min, sphere.center);
  EXPECT_EQ(bounds.box(sphere).max, sphere.center);
  EXPECT_EQ(bounds.cylinder(sphere).radius, 0.0F);
}

}  // namespace
}  // namespace occlod
