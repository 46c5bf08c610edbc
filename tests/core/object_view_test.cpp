#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

#include "occlod/base.h"
#include "occlod/view.h"
#include "support/cameras.h"

namespace occlod {
namespace {

Camera camera() {
  Camera c;
  c.eye = {1, 2, 6};
  c.target = {0, 0.5, 0};
  c.fov_y_deg = 70.0;
  c.near = 0.1;
  c.far = 50.0;
  return c;
}

class RandomNumbers {
 public:
  explicit RandomNumbers(unsigned seed) : random_(seed) {}
  double between(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  glm::dvec3 in_cube(double half) { return {between(-half, half), between(-half, half), between(-half, half)}; }
  glm::dvec3 in_unit_ball() {
    glm::dvec3 p;
    do p = in_cube(1.0);
    while (glm::length(p) > 1.0);
    return p;
  }

 private:
  std::mt19937 random_;
};

glm::dmat4 random_transform(RandomNumbers& random) {
  glm::dmat4 m = glm::translate(glm::dmat4(1.0), random.in_cube(2.0));
  m = glm::rotate(m, random.between(0, 6.28), random.in_unit_ball() + glm::dvec3(0.01));
  return glm::scale(m, {random.between(0.2, 3), random.between(0.2, 3), random.between(-3, 3) + 0.01});
}

bool inside_frustum(const glm::dvec4& clip) {
  return std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w && std::abs(clip.z) <= clip.w;
}

TEST(ObjectView, ASphereWithAPointInTheFrustumIsNeverOutside) {
  RandomNumbers random(1);
  const View view(camera());
  int outside = 0;
  for (int n = 0; n < 4000; ++n) {
    const glm::dmat4 transform = random_transform(random);
    const ObjectView object(view, transform);
    const Sphere sphere{glm::vec3(random.in_cube(4.0)), static_cast<float>(random.between(0, 1))};
    if (!object.may_be_inside(sphere)) ++outside;
    for (int k = 0; k < 20; ++k) {
      const glm::dvec3 p =
          glm::dvec3(sphere.center) + 0.999 * static_cast<double>(sphere.radius) * random.in_unit_ball();
      if (inside_frustum(view.world_to_clip() * transform * glm::dvec4(p, 1.0))) {
        ASSERT_TRUE(object.may_be_inside(sphere));
      }
    }
  }
  EXPECT_GT(outside, 400);
}

// Parallel rays: a unit covers as many pixels everywhere; a cone turns away or not wherever it is. Looking along -z, a
// cone around an axis 60 degrees from -z turns away up to a half angle of 30 degrees.
TEST(ObjectView, OrthographicScaleAndFacingDoNotDependOnThePlace) {
  Camera c;
  c.eye = {0, 0, 10};
  c.target = {0, 0, 0};
  c.orthographic_height = 8.0;
  c.width = c.height = 100;
  const ObjectView object(View(c), glm::scale(glm::dmat4(1.0), glm::dvec3(2.0)));
  const glm::vec3 axis(std::sin(std::numbers::pi / 3.0), 0.0, -std::cos(std::numbers::pi / 3.0));
  for (const glm::vec3& center : {glm::vec3(0, 0, 0), glm::vec3(1.9F, -1.9F, 4.0F), glm::vec3(-1.9F, 1.9F, -40.0F)})
    for (const float radius : {0.0F, 1.0F, 30.0F}) {
      const Sphere sphere{center, radius};
      EXPECT_NEAR(object.largest_scale_px(sphere), 25.0F, 1e-4F);  // 2 world units each, 100 px in 8 of them
      const auto cone = [&](double degrees) {
        return NormalCone{axis, static_cast<float>(std::cos(degrees * std::numbers::pi / 180.0))};
      };
      EXPECT_TRUE(faces_away(cone(29.99), sphere, object.eye()));
      EXPECT_FALSE(faces_away(cone(30.0), sphere, object.eye()));
    }
}

TEST(ObjectView, OrthographicPlanesAreABox) {
  Camera c;
  c.eye = {0, 0, 10};
  c.target = {0, 0, 0};
  c.orthographic_height = 8.0;
  c.width = 200;
  c.height = 100;
  c.near = 1.0;
  c.far = 15.0;
  const ObjectView object(View(c), glm::dmat4(1.0));
  const auto inside = [&](float x, float y, float z) { return object.may_be_inside({{x, y, z}, 1.0F}); };
  for (const float sign : {-1.0F, 1.0F}) {
    EXPECT_TRUE(inside(8.99F * sign, 0, 0));  // 8 wide to each side
    EXPECT_FALSE(inside(9.01F * sign, 0, 0));
    EXPECT_TRUE(inside(0, 4.99F * sign, 0));
    EXPECT_FALSE(inside(0, 5.01F * sign, 0));
  }
  EXPECT_TRUE(inside(0, 0, 9.99F));  // the near plane is at 9
  EXPECT_FALSE(inside(0, 0, 10.01F));
  EXPECT_TRUE(inside(0, 0, -5.99F));  // the far plane at -5
  EXPECT_FALSE(inside(0, 0, -6.01F));
}

TEST(ObjectView, OrthographicRefusesWhatIsTooFarAway) {
  Camera c = camera();
  c.orthographic_height = 1.0;
  c.far = 1e32;
  EXPECT_THROW(ObjectView(View(c), glm::dmat4(1.0)), Error);
  c.far = 1e28;
  EXPECT_NO_THROW(ObjectView(View(c), glm::dmat4(1.0)));
}

TEST(ObjectView, EachPlaneCutsWhereItShould) {
  // Eye at the origin, looking along -z, 90 degrees high and wide: a unit sphere at depth 10 touches the side planes
  // when its centre is 10 + sqrt(2) off the axis.
  Camera c = test::origin_camera(100, 100);
  c.near = 2.0;
  c.far = 20.0;
  const ObjectView object(View(c), glm::dmat4(1.0));
  const float touching = 10.0F + std::sqrt(2.0F);
  for (const glm::vec3 side : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, -1, 0)}) {
    EXPECT_TRUE(object.may_be_inside({glm::vec3(0, 0, -10) + (touching - 0.01F) * side, 1.0F}));
    EXPECT_FALSE(object.may_be_inside({glm::vec3(0, 0, -10) + (touching + 0.01F) * side, 1.0F}));
  }
  EXPECT_TRUE(object.may_be_inside({{0, 0, -1.01F}, 1.0F}));
  EXPECT_FALSE(object.may_be_inside({{0, 0, -0.99F}, 1.0F}));
  EXPECT_TRUE(object.may_be_inside({{0, 0, -20.99F}, 1.0F}));
  EXPECT_FALSE(object.may_be_inside({{0, 0, -21.01F}, 1.0F}));
}

TEST(ObjectView, NoDisplacementCoversMorePixelsThanTheLargestScale) {
  RandomNumbers random(2);
  const View view(camera());
  int compared = 0;
  double tightest = 0.0;
  for (int n = 0; n < 3000; ++n) {
    const glm::dmat4 transform = random_transform(random);
    const ObjectView object(view, transform);
    const Sphere sphere{glm::vec3(random.in_cube(3.0)), static_cast<float>(random.between(0, 0.5))};
    const auto scale = static_cast<double>(object.largest_scale_px(sphere));
    const auto to_pixels = [&](const glm::dvec3& p) {
      const glm::dvec4 clip = view.world_to_clip() * transform * glm::dvec4(p, 1.0);
      return glm::dvec2(clip) / clip.w * glm::dvec2(view.width(), view.height()) / 2.0;
    };
    for (int k = 0; k < 10; ++k) {
      const glm::dvec3 p = glm::dvec3(sphere.center) + static_cast<double>(sphere.radius) * random.in_unit_ball();
      if (!inside_frustum(view.world_to_clip() * transform * glm::dvec4(p, 1.0))) continue;
      const glm::dvec3 step = 1e-6 * glm::normalize(random.in_unit_ball() + glm::dvec3(1e-9));
      const double pixels = glm::length(to_pixels(p + step) - to_pixels(p)) / 1e-6;
      ASSERT_LE(pixels, scale * (1.0 + 1e-5));
      if (std::isfinite(scale)) tightest = std::max(tightest, pixels / scale);
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
  EXPECT_GT(tightest, 0.7);  // a bound, but not one that is far from the truth everywhere
}

TEST(ObjectView, ScaleAtTheCentreOfTheImageIsTheFocalLengthOverTheDistance) {
  const Camera c = test::origin_camera(100, 100);  // focal length 50 px
  const ObjectView object(View(c), glm::dmat4(1.0));
  EXPECT_NEAR(object.largest_scale_px({{0, 0, -10}, 0.0F}), 5.0F, 1e-5F);
  // Nearest at 8; seen under the angle asin(2 / 10) to the side: / cos^2.
  EXPECT_NEAR(object.largest_scale_px({{0, 0, -10}, 2.0F}), 50.0F / 8.0F / 0.96F, 1e-4F);
  EXPECT_EQ(object.largest_scale_px({{0, 0, -1}, 1.5F}), std::numeric_limits<float>::infinity());
  // Twice the size is twice the pixels for the same object length.
  const ObjectView doubled(View(c), glm::scale(glm::dmat4(1.0), glm::dvec3(2.0)));
  EXPECT_NEAR(doubled.largest_scale_px({{0, 0, -5}, 0.0F}), 10.0F, 1e-5F);
}

TEST(ObjectView, EyeAndMirroringAreTheObjects) {
  const View view(camera());
  const ObjectView moved(view, glm::translate(glm::dmat4(1.0), {1, 2, 3}));
  EXPECT_NEAR(moved.eye().x, 0.0F, 1e-6F);
  EXPECT_NEAR(moved.eye().y, 0.0F, 1e-6F);
  EXPECT_NEAR(moved.eye().z, 3.0F, 1e-6F);
  EXPECT_FALSE(moved.mirrored());
  EXPECT_TRUE(ObjectView(view, glm::scale(glm::dmat4(1.0), {1, -1, 1})).mirrored());
}

TEST(ObjectView, RefusesTransformsWithoutAnInverse) {
  const View view(camera());
  EXPECT_THROW(ObjectView(view, glm::scale(glm::dmat4(1.0), {1, 0, 1})), Error);
  glm::dmat4 nan(1.0);
  nan[3].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ObjectView(view, nan), Error);
  glm::dmat4 projective(1.0);
  projective[2].w = 1.0;
  EXPECT_THROW(ObjectView(view, projective), Error);
}

}  // namespace
}  // namespace occlod
