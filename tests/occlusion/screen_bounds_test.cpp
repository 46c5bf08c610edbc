// The rectangle holds every pixel that a bound touches, and its depth is nearer than every point of it.
#include "raster/screen_bounds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <limits>
#include <vector>

#include "oracle/random_shapes.h"
#include "support/cameras.h"

namespace occlod {
namespace {

using test::BoundKind;
using test::project;
using test::Projected;
using test::RandomShapes;

TEST(ScreenBounds, ContainManySamplesOfEveryShape) {
  RandomShapes random(1);
  std::array<int, 4> trusted{}, refused{};
  for (int n = 0; n < 3000; ++n) {
    const View view = random.view();
    const glm::dmat4 placement = random.placement();
    const ObjectView object(view, placement);
    const int kind = n % 4;
    const VisibilityQuery query = random.bound(static_cast<BoundKind>(kind), random.in(0.01, 2.0));
    const std::optional<ScreenBounds> bounds = screen_bounds(view, object, query);
    ++(bounds ? trusted : refused)[static_cast<std::size_t>(kind)];
    for (int i = 0; i < 300; ++i) {
      const std::optional<Projected> p = project(view, placement, random.sample(query));
      if (!bounds) break;
      ASSERT_TRUE(p) << "a bound that crosses the near plane has no rectangle";
      ASSERT_LE(p->nearness, bounds->largest_nearness);
      const double x = std::floor(p->x), y = std::floor(p->y);
      if (x < 0 || y < 0 || x >= view.width() || y >= view.height()) continue;
      ASSERT_TRUE(x >= bounds->rect.x0 && x < bounds->rect.x1 && y >= bounds->rect.y0 && y < bounds->rect.y1)
          << "kind " << kind << " view " << n;
    }
  }
  for (std::size_t kind = 0; kind < 4; ++kind) {
    EXPECT_GT(trusted[kind], 50);
    EXPECT_GT(refused[kind], 50);
  }
}

TEST(ScreenBounds, DiagonalsContainManySamplesAndFewMore) {
  RandomShapes random(5);
  int checked = 0;
  for (int n = 0; n < 2000; ++n) {
    const View view = random.view();
    const glm::dmat4 placement = random.placement();
    const VisibilityQuery query = random.bound(static_cast<BoundKind>(n % 4), random.in(0.01, 2.0));
    const ObjectView object(view, placement);
    if (!screen_bounds(view, object, query)) continue;
    const Diagonals diagonals = screen_diagonals(view, object, query);
    double sum_low = 1e9, sum_high = -1e9, difference_low = 1e9, difference_high = -1e9;
    for (int i = 0; i < 1000; ++i) {
      const std::optional<Projected> p = project(view, placement, random.sample(query));
      ASSERT_TRUE(p);
      sum_low = std::min(sum_low, p->x + p->y), sum_high = std::max(sum_high, p->x + p->y);
      difference_low = std::min(difference_low, p->x - p->y), difference_high = std::max(difference_high, p->x - p->y);
    }
    ASSERT_GE(sum_low, diagonals.sum_low);
    ASSERT_LE(sum_high, diagonals.sum_high);
    ASSERT_GE(difference_low, diagonals.difference_low);
    ASSERT_LE(difference_high, diagonals.difference_high);
    // 1000 samples leave a cap of a few percent unseen.
    const double gap = 0.1 * std::max(sum_high - sum_low, difference_high - difference_low) + 0.1;
    ASSERT_LE(sum_low - diagonals.sum_low, gap);
    ASSERT_LE(diagonals.sum_high - sum_high, gap);
    ASSERT_LE(difference_low - diagonals.difference_low, gap);
    ASSERT_LE(diagonals.difference_high - difference_high, gap);
    ++checked;
  }
  EXPECT_GT(checked, 200);
}

// The outline of a round shape is its own, not that of a box around it: the rectangle is at most 1 + 2 / 256 pixels and
// the gap between samples larger than the range of the samples.
TEST(ScreenBounds, AreTight) {
  RandomShapes random(2);
  int checked = 0;
  for (int n = 0; n < 2000; ++n) {
    const View view = random.view();
    const glm::dmat4 placement = random.placement();
    const VisibilityQuery query = random.bound(static_cast<BoundKind>(n % 4), 0.8);
    const std::optional<ScreenBounds> bounds = screen_bounds(view, ObjectView(view, placement), query);
    if (!bounds) continue;
    double x0 = 1e9, x1 = -1e9, y0 = 1e9, y1 = -1e9, nearest = 0.0;
    for (int i = 0; i < 4000; ++i) {
      const std::optional<Projected> p = project(view, placement, random.sample(query));
      ASSERT_TRUE(p);
      x0 = std::min(x0, p->x), x1 = std::max(x1, p->x), y0 = std::min(y0, p->y), y1 = std::max(y1, p->y);
      nearest = std::max(nearest, p->nearness);
    }
    if (x0 < 0 || y0 < 0 || x1 >= view.width() || y1 >= view.height()) continue;  // only whole shapes
    const double gap = 0.04 * std::max(x1 - x0, y1 - y0) + 1.01;  // 4000 samples leave a cap of 2 % of the size unseen
    EXPECT_GE(bounds->rect.x0, x0 - gap) << n;
    EXPECT_GE(bounds->rect.y0, y0 - gap) << n;
    EXPECT_LE(bounds->rect.x1, x1 + gap) << n;
    EXPECT_LE(bounds->rect.y1, y1 + gap) << n;
    // Rounded up, so not 0 even where the nearest sample is on the far plane.
    EXPECT_LE(bounds->largest_nearness, nearest * 1.05 + std::numeric_limits<float>::denorm_min()) << n;
    ++checked;
  }
  EXPECT_GT(checked, 50);
}

// At the origin, looking along -z, f = 50 px, image 100 x 100.
View plain_view() {
  Camera camera = test::origin_camera(100, 100);
  camera.near = 0.5;
  return View(camera);
}

std::optional<ScreenBounds> plain_bounds(const VisibilityQuery& query) {
  const View view = plain_view();
  return screen_bounds(view, ObjectView(view, glm::dmat4(1.0)), query);
}

TEST(ScreenBounds, OfASphereOnTheAxisEndAtItsTangents) {
  // Radius 3 at distance 5: the tangent's slope is 3 / sqrt(25 - 9) = 0.75, so it reaches 37.5 px from the middle:
  // pixels 12 to 87. Its box would reach 50 * 3 / 2 = 75 px.
  const auto bounds = plain_bounds({0, Sphere{{0, 0, -5}, 3.0F}});
  ASSERT_TRUE(bounds);
  EXPECT_EQ(bounds->rect.x0, 12);
  EXPECT_EQ(bounds->rect.x1, 88);
  EXPECT_EQ(bounds->rect.y0, 12);
  EXPECT_EQ(bounds->rect.y1, 88);
  EXPECT_NEAR(bounds->largest_nearness, 0.5, 1e-5);
  EXPECT_GE(bounds->largest_nearness, 0.5F);
}

TEST(ScreenBounds, KnowUpFromDown) {
  // 50 * 2 / 5 = 20 px right of and 50 * 1 / 5 = 10 px above the middle; 1/256 px of slack reaches over both borders of
  // the pixels there.
  const glm::vec3 point(2, 1, -5);
  const auto bounds = plain_bounds({0, PointHull{{&point, 1}}});
  ASSERT_TRUE(bounds);
  EXPECT_EQ(bounds->rect.x0, 69);
  EXPECT_EQ(bounds->rect.x1, 71);
  EXPECT_EQ(bounds->rect.y0, 39);
  EXPECT_EQ(bounds->rect.y1, 41);
}

// The rasteriser moves corners by up to half of 1/256 px. (Fails with bounds_slack_px 0.)
TEST(ScreenBounds, ReachOverABorderThatIsNearerThanTheSubpixels) {
  // At 50 + 50 * x / 5 px: 3/1000 px right of the left border of pixel 70, and 6/1000 px.
  const glm::vec3 near_border(2.0003F, 0.05F, -5), far_from_it(2.0006F, 0.05F, -5);
  EXPECT_EQ(plain_bounds({0, PointHull{{&near_border, 1}}})->rect.x0, 69);
  EXPECT_EQ(plain_bounds({0, PointHull{{&far_from_it, 1}}})->rect.x0, 70);
}

TEST(ScreenBounds, AreEmptyBesideTheImage) {
  for (const glm::vec3& center :
       {glm::vec3(-20, 0, -5), glm::vec3(20, 0, -5), glm::vec3(0, -20, -5), glm::vec3(0, 20, -5)}) {
    const auto bounds = plain_bounds({0, Sphere{center, 2.0F}});
    ASSERT_TRUE(bounds);
    EXPECT_TRUE(bounds->rect.x0 >= bounds->rect.x1 || bounds->rect.y0 >= bounds->rect.y1);
  }
}

TEST(ScreenBounds, AreRefusedWhereTheyCannotBeTrusted) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const glm::vec3 up(0, 1, 0);
  const std::vector<glm::vec3> crossing = {{0, 0, -5}, {0, 0, -0.4F}};
  const std::vector<glm::vec3> broken = {{0, 0, -5}, {0, nan, -5}};
  EXPECT_FALSE(plain_bounds({0, Sphere{{0, 0, 0}, 1.0F}}));   // the eye inside
  EXPECT_FALSE(plain_bounds({0, Sphere{{0, 0, -2}, 1.6F}}));  // nearest point at 0.4
  EXPECT_TRUE(plain_bounds({0, Sphere{{0, 0, -2}, 1.4F}}));   // at 0.6
  EXPECT_FALSE(plain_bounds({0, Sphere{{0, 0, 5}, 1.0F}}));   // behind the eye
  EXPECT_FALSE(plain_bounds({0, Box{{-1, -1, -5}, {1, 1, -0.4F}}}));
  EXPECT_TRUE(plain_bounds({0, Box{{-1, -1, -5}, {1, 1, -0.6F}}}));
  EXPECT_FALSE(plain_bounds({0, Cylinder{{0, 0, -2}, 1.6F, up, -1, 1}}));
  EXPECT_TRUE(plain_bounds({0, Cylinder{{0, 0, -2}, 1.4F, up, -1, 1}}));
  EXPECT_FALSE(plain_bounds({0, Cylinder{{0, 0, -2}, 0.1F, {0, 0, 1}, 0, 1.6F}}));  // along the axis of view
  EXPECT_TRUE(plain_bounds({0, Cylinder{{0, 0, -2}, 1.6F, {0, 0, 1}, 0, 1.4F}}));
  EXPECT_FALSE(plain_bounds({0, PointHull{crossing}}));
  EXPECT_FALSE(plain_bounds({0, PointHull{broken}}));
  EXPECT_FALSE(plain_bounds({0, Sphere{{nan, 0, -5}, 1.0F}}));
  EXPECT_FALSE(plain_bounds({0, Sphere{{0, 0, -5}, nan}}));
  EXPECT_FALSE(plain_bounds({0, Sphere{{0, 0, -5}, infinity}}));
  EXPECT_FALSE(plain_bounds({0, Sphere{{infinity, 0, -5}, 1.0F}}));
  EXPECT_FALSE(plain_bounds({0, Box{{-infinity, -1, -5}, {1, 1, -4}}}));
  EXPECT_FALSE(plain_bounds({0, Cylinder{{0, 0, -5}, 1.0F, {0, nan, 0}, 0, 1}}));
  EXPECT_FALSE(plain_bounds({0, Cylinder{{0, 0, -5}, 1.0F, up, 0, infinity}}));
}

// An object far from its own origin: single-precision object_to_clip then has large terms that cancel, and the slack
// must cover them.
TEST(ScreenBounds, CoverTheRoundingOfTheMatrix) {
  RandomShapes random(3);
  for (int n = 0; n < 2000; ++n) {
    const View view = random.view();
    // Object coordinates near (1000, 2000, -500), moved back to where the eye is.
    const glm::dvec3 offset(1000, 2000, -500);
    const glm::dmat4 placement = random.placement() * glm::translate(glm::dmat4(1.0), -offset);
    const glm::vec3 center = glm::vec3(offset + random.point(4.0));
    const VisibilityQuery query = {0, Sphere{center, 0.25F}};
    const std::optional<ScreenBounds> bounds = screen_bounds(view, ObjectView(view, placement), query);
    if (!bounds) continue;
    for (int i = 0; i < 200; ++i) {
      const std::optional<Projected> p = project(view, placement, random.sample(query));
      ASSERT_TRUE(p);
      ASSERT_LE(p->nearness, bounds->largest_nearness);
      const double x = std::floor(p->x), y = std::floor(p->y);
      if (x < 0 || y < 0 || x >= view.width() || y >= view.height()) continue;
      ASSERT_TRUE(x >= bounds->rect.x0 && x < bounds->rect.x1 && y >= bounds->rect.y0 && y < bounds->rect.y1) << n;
    }
  }
}

}  // namespace
}  // namespace occlod
