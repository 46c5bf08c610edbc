// Views on which rounding to single precision, or the textbook's formula, would cull what is seen or promise too
// little.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <string>

#include "occlod/base.h"
#include "occlod/view.h"

namespace occlod {
namespace {

// 90 degrees high and wide, along -z: focal length 50 px, side planes at 45 degrees.
Camera camera_at(const glm::dvec3& eye) {
  Camera c;
  c.eye = eye;
  c.target = eye + glm::dvec3(0, 0, -1);
  c.fov_y_deg = 90.0;
  c.width = c.height = 100;
  c.near = 1e-6;
  c.far = 1e9;
  return c;
}

// As a sum of rows of the matrix to clip space the far plane has the factor 1 - (f + n) / (f - n), of which rounding
// leaves 9 * 2^-52: a plane at a depth of 1.0008e9.
TEST(HardView, FarPlaneIsNotRoundingOnly) {
  Camera c = camera_at({0, 0, 0});
  c.far = 1.01e9;
  const ObjectView object(View(c), glm::dmat4(1.0));
  EXPECT_TRUE(object.may_be_inside({{0, 0, -1.005e9F}, 0.0F}));
  EXPECT_FALSE(object.may_be_inside({{0, 0, -1.015e9F}, 0.0F}));
}

// World coordinates of 1e9 are rounded by 1e-7; the picture of an object's local coordinates must not be. 1 mm before
// the eye the frustum is 2 mm wide: points 1e-8 inside its sides are seen.
TEST(HardView, SidePlanesFarFromTheOrigin) {
  const glm::dvec3 place(1e9, -1e9, 1e9), ahead = glm::normalize(glm::dvec3(1, 2, -3));
  const glm::dvec3 eye = 0x1p-20 * glm::dvec3(3, 5, -7);  // from there: exact
  Camera c = camera_at(place + eye);
  c.target = c.eye + ahead;
  const glm::dvec3 right = glm::normalize(glm::cross(c.target - c.eye, c.up)), up = glm::cross(right, ahead);
  const ObjectView object(View(c), glm::translate(glm::dmat4(1.0), place));
  for (const glm::dvec3& side : {right, -right, up, -up}) {
    EXPECT_TRUE(object.may_be_inside({eye + 1e-3 * (ahead + (1.0 - 1e-5) * side), 0.0F}));
    EXPECT_FALSE(object.may_be_inside({eye + 1e-3 * (ahead + (1.0 + 1e-5) * side), 0.0F}));
  }
}

// An object 1.4e9 away on the edge of the picture. tan(pi / 4) is 1 - 2^-53 in double precision, so planes computed
// from it are 1e-16 too narrow: 2e-7 there. Points 1e-7 inside the true ones, with coordinates so small that a
// millionth of them is nothing, are seen. (Fails without the 1e-15 by which unit_plane() moves planes outwards.)
TEST(HardView, PlanesAreMovedOutwardsByWhatDoublesRound) {
  for (const glm::dvec3& side :
       {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0)}) {
    Camera c = camera_at({0, 0, 0});
    c.far = 1e10;
    const ObjectView object(View(c), glm::translate(glm::dmat4(1.0), 1e9 * (side - glm::dvec3(0, 0, 1))));
    EXPECT_TRUE(object.may_be_inside({-1e-7 * side, 0.0F}));
    EXPECT_FALSE(object.may_be_inside({1e-5 * side, 0.0F}));
  }
}

// The eye is (1/8, 1/4, 1/2) from the object in the world, exactly; turned back by the angle of cosine 0.6, sine 0.8.
TEST(HardView, EyeFarFromTheOriginIsTheDifference) {
  const glm::dvec3 place(1e9, -1e9, 1e9);
  glm::dmat4 transform = glm::translate(glm::dmat4(1.0), place);
  transform[0] = {0.6, 0.8, 0, 0};
  transform[1] = {-0.8, 0.6, 0, 0};
  const ObjectView object(View(camera_at(place + glm::dvec3(0.125, 0.25, 0.5))), transform);
  EXPECT_NEAR(object.eye().x, 0.6 * 0.125 + 0.8 * 0.25, 3e-8);
  EXPECT_NEAR(object.eye().y, -0.8 * 0.125 + 0.6 * 0.25, 3e-8);
  EXPECT_NEAR(object.eye().z, 0.5, 3e-8);
}

// Floats around 1e6 are 1/16 apart: the eye at 1e6 + 0.03 becomes 1e6. n . (eye - p) is 0.6 * 0.03 - 0.8 * 0.01 > 0,
// the face is seen from its front, but with the rounded eye it is -0.008.
TEST(HardView, FaceBetweenTheEyeAndItsRoundingIsSeen) {
  const ObjectView object(View(camera_at({1e6 + 0.03, 0, 0})), glm::dmat4(1.0));
  ASSERT_EQ(object.eye().x, 1e6F);
  const NormalCone cone{{0.6F, 0.8F, 0.0F}, 0.99999F};
  EXPECT_FALSE(faces_away(cone, {{1e6F, 0.01F, 0.0F}, 0.0F}, object.eye()));
  EXPECT_TRUE(faces_away(cone, {{1e6F, 1.0F, 0.0F}, 0.0F}, object.eye()));  // far behind
}

// n = (-sqrt(1 - c^2), 0, c) is in the cone, and n . d = 1.4e-4 - 1.5e-4 < 0: its front is seen. |d|^2 - along^2 is 0
// in single precision, as if d were along the axis, and c > 0.
TEST(HardView, DirectionNearlyAlongTheAxisOfAWideCone) {
  const NormalCone cone{{0, 0, 1}, 1.4e-4F};
  EXPECT_FALSE(faces_away(cone, {{1.5e-4F, 0.0F, 1.0F}, 0.0F}, {0, 0, 0}));
  EXPECT_TRUE(faces_away(cone, {{1.0e-4F, 0.0F, 1.0F}, 0.0F}, {0, 0, 0}));
}

// A cone is all unit n with dot(n, axis) >= cos_angle, and its axis is a unit vector only as far as floats are: where
// it is 6e-8 too long the cone is that much wider. Faces whose normal is at its very rim, seen from their front at a
// small angle, are not facing away. (Fails with facing_slack 0.)
TEST(HardView, AxisThatIsAUnitVectorOfFloats) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(0.05, 0.95);
  const auto direction = [&] { return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))); };
  int judged = 0;
  for (int i = 0; i < 20'000; ++i) {
    const NormalCone cone{glm::vec3(direction()), static_cast<float>(share(random))};
    const glm::dvec3 axis(cone.axis), across = glm::normalize(glm::cross(axis, direction()));
    const double tilt = std::acos(static_cast<double>(cone.cos_angle) / glm::length(axis)) * (1.0 - 1e-12);
    const glm::dvec3 n = std::cos(tilt) * glm::normalize(axis) + std::sin(tilt) * across;
    // Nearly across n, on the side of the axis.
    const glm::dvec3 d = std::sin(tilt) * glm::normalize(axis) - std::cos(tilt) * across - 2e-8 * n;
    const Sphere point{glm::vec3(d), 0.0F};
    if (!(glm::dot(n, axis) >= static_cast<double>(cone.cos_angle) && glm::dot(n, glm::dvec3(point.center)) < -1e-9))
      continue;  // rounding the point has moved it behind the face
    ++judged;
    ASSERT_FALSE(faces_away(cone, point, {0, 0, 0})) << i;
  }
  EXPECT_GT(judged, 5000);
}

// Squares of 1e-25 and of 1e25 are no floats.
TEST(HardView, FacesAwayAtAnySize) {
  const NormalCone cone{{0, 0, 1}, 0.6F};  // sees past directions that are farther than 36.9 degrees from its axis
  for (const float size : {1e-30F, 1e-25F, 1.0F, 1e25F, 1e30F}) {
    EXPECT_TRUE(faces_away(cone, {{0.7F * size, 0, size}, 0.0F}, {0, 0, 0}));
    EXPECT_FALSE(faces_away(cone, {{0.8F * size, 0, size}, 0.0F}, {0, 0, 0}));
  }
}

// The eye at 1e6 + 0.04 would be rounded to 1e6 + 0.0625: 16 instead of 25 times the focal length.
TEST(HardView, ScaleFarFromTheOrigin) {
  const ObjectView object(View(camera_at({0, 0, 1e6 + 0.04})), glm::dmat4(1.0));
  EXPECT_NEAR(object.largest_scale_px({{0, 0, 1e6F}, 0.0F}), 50.0 * 25.0, 1e-3);
}

TEST(HardView, ScaleAtAnySize) {
  for (const double size : {1e-30, 1e-20, 1e20, 1e30}) {
    Camera c = camera_at({0, 0, 0});
    c.target = {0, 0, -size};
    c.near = 0.1 * size;
    c.far = 10.0 * size;
    const ObjectView object(View(c), glm::dmat4(1.0));
    EXPECT_NEAR(static_cast<double>(object.largest_scale_px({{0, 0, -size}, 0.0F})) * size, 50.0, 1e-4) << size;
  }
}

TEST(HardView, EyeInTheBoundsCullsNothing) {
  const ObjectView object(View(camera_at({1, 2, 3})), glm::dmat4(1.0));
  for (const float radius : {0.0F, 1e-6F, 1.0F, 1e9F}) {  // 0: the eye on a vertex
    const Sphere sphere{{1, 2, 3}, radius};
    EXPECT_FALSE(faces_away({{0, 0, -1}, 0.999F}, sphere, object.eye()));
    EXPECT_EQ(object.largest_scale_px(sphere), std::numeric_limits<float>::infinity());
    EXPECT_TRUE(object.may_be_inside(sphere) || radius == 0.0F);  // a point at the eye is before the near plane
  }
}

TEST(HardView, SmallestAndLargestPictures) {
  for (const int side : {1, 16384})
    for (const double fov : {1.0, 179.0}) {
      Camera c = camera_at({0, 0, 0});
      c.width = c.height = side;
      c.fov_y_deg = fov;
      const ObjectView object(View(c), glm::dmat4(1.0));
      const double half = std::tan(fov * 3.14159265358979 / 360.0);
      EXPECT_NEAR(object.largest_scale_px({{0, 0, -1}, 0.0F}) / (side / 2.0 / half), 1.0, 1e-5);
      EXPECT_TRUE(object.may_be_inside({{0.999 * half, 0, -1}, 0.0F}));
      EXPECT_FALSE(object.may_be_inside({{1.001 * half, 0, -1}, 0.0F}));
    }
}

// What the caller of View or ObjectView is told.
template <typename Make>
std::string complaint(const Make& make) {
  try {
    make();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing";
}

TEST(HardView, RefusalsAreOneLineThatNamesThePlace) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto refused = [](const std::string& place, auto change) {
    Camera c = camera_at({0, 0, 0});
    change(c);
    const std::string said = complaint([&] { View{c}; });
    EXPECT_EQ(said.rfind("camera: " + place, 0), 0U) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos);
  };
  refused("eye", [&](Camera& c) { c.eye.z = nan; });
  refused("target", [&](Camera& c) { c.target.x = infinity; });
  refused("fov_y_deg", [&](Camera& c) { c.fov_y_deg = nan; });
  refused("size", [](Camera& c) { c.height = 0; });
  refused("size", [](Camera& c) { c.width = 16385; });
  refused("near, far", [&](Camera& c) { c.near = nan; });
  refused("near, far", [&](Camera& c) { c.far = infinity; });
  const View view(camera_at({0, 0, 0}));
  glm::dmat4 flat(1.0);
  flat[1] = 2.0 * flat[0];  // two axes along one line
  EXPECT_EQ(complaint([&] { ObjectView(view, flat); }).rfind("object: transform", 0), 0U);
}

}  // namespace
}  // namespace occlod
