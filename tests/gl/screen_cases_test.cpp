// Where a bound is on the screen and along the line of sight: pixels, borders, the eye and both planes.
#include <cmath>

#include "gl/backend_cases.h"

namespace occlod::gl {
namespace {

class ScreenCases : public BackendCases {};
INSTANTIATE_TEST_SUITE_P(Gl, ScreenCases, testing::ValuesIn(tested_backends()), backend_label);

// Wherever in a pixel it lies, with corners and edges of pixels among the places.
TEST_P(ScreenCases, SubPixelInFrontIsVisible) {
  each_kind([&] {
    for (int i = 0; i < 64; ++i) {
      const float z = 0.01F;
      const auto pixel = static_cast<float>(pixel_at_wall * (3.0 - 0.01) / 3.0);
      const glm::vec3 center(pixel * (3.0F + static_cast<float>(i % 8) / 8.0F),
                             pixel * (-5.0F + static_cast<float>(i - i % 8) / 64.0F), z);
      EXPECT_EQ(ask(at(center, 1e-4F)), 1U) << i;
    }
  });
}

// The hole is pixel [10, 11) x [5, 6) right and up of the middle, moved by whole pixels, so exactly one sample sees
// through it.
class OnePixelHole : public BackendCases {
 protected:
  void start_hole(int x, int y) {
    x0_ = (10 + x) * pixel_at_wall;
    y0_ = (5 + y) * pixel_at_wall;
    start(wall_with_hole(static_cast<float>(x0_), static_cast<float>(x0_ + pixel_at_wall), static_cast<float>(y0_),
                         static_cast<float>(y0_ + pixel_at_wall)));
  }
  // The point seen through the wall at pixel coordinates (x, y) from the hole's lower left, at z = -1: depth 4 instead
  // of 3.
  [[nodiscard]] glm::vec3 behind(double x, double y) const {
    return {static_cast<float>((x0_ + x * pixel_at_wall) * 4.0 / 3.0),
            static_cast<float>((y0_ + y * pixel_at_wall) * 4.0 / 3.0), -1.0F};
  }

 private:
  double x0_ = 0.0;
  double y0_ = 0.0;
};
INSTANTIATE_TEST_SUITE_P(Gl, OnePixelHole, testing::ValuesIn(tested_backends()), backend_label);

TEST_P(OnePixelHole, ShowsWhatIsBehindIt) {
  each_kind([&] {
    start_hole(0, 0);
    EXPECT_EQ(ask(at(behind(0.5, 0.5), 0.2F)), 1U);
    // Three samples beside the hole: farther than a proxy may grow.
    const double away = 3.0 * GetParam().divisor();
    EXPECT_EQ(ask(at(behind(-away, 0.5), 1e-4F)), 0U);
    EXPECT_EQ(ask(at(behind(0.5, -away), 1e-4F)), 0U);
  });
}

// A bound no larger than a hundredth of a pixel in the last corners of the hole's pixel touches that pixel, 0.7 pixels
// from its sample. A proxy grown by less, or drawn beside its place, would miss it. Wherever the pixel lies among those
// that share a sample of a smaller target.
TEST_P(OnePixelHole, ShowsWhatTouchesTheCornersOfItsPixel) {
  each_kind([&] {
    for (int hole = 0; hole < 9; ++hole) {
      start_hole(hole % 3, hole / 3);
      for (const double x : {0.01, 0.99})
        for (const double y : {0.01, 0.99}) EXPECT_EQ(ask(at(behind(x, y), 1e-5F)), 1U) << hole << " " << x << " " << y;
    }
  });
}

// At z = 0 the screen ends at |x| = 1.657 and |y| = 1.243. These are more than ten pixels beyond: farther than proxies
// grow for the smallest target. Nothing of them is in the picture, whatever stands there.
TEST_P(ScreenCases, OffTheScreenIsHidden) {
  each_kind([&] {
    for (const float x : {-2.4F, 0.0F, 2.4F})
      for (const float y : {-2.0F, 0.0F, 2.0F})
        if (x != 0.0F || y != 0.0F) {
          EXPECT_EQ(ask(at({x, y, 0}, 0.1F)), 0U) << x << " " << y;
        }
  });
}

// Each reaches a hundredth of a pixel into the picture, over one of its borders or corners, and nothing hides it there.
TEST_P(ScreenCases, TouchingTheBorderIsVisible) {
  each_kind([&] {
    const float half = 0.1F;
    const float z = 0.2F;
    const double pixel = pixel_at_wall * (3.0 - z) / 3.0;
    const bool round = kind_ == test::BoundKind::sphere || kind_ == test::BoundKind::cylinder;
    for (const int x : {-1, 0, 1})
      for (const int y : {-1, 0, 1}) {
        if (x == 0 && y == 0) continue;
        // How far it reaches towards the picture from its centre, in x and in y.
        const double reach = round && x != 0 && y != 0 ? half / std::sqrt(2.0) : half;
        const glm::vec3 center(x * (31.99 * pixel + reach), y * (23.99 * pixel + reach), z);
        EXPECT_EQ(ask(at(center, half)), 1U) << x << " " << y;
      }
  });
}

// Half of it is beyond the border, where no wall is needed to hide it.
TEST_P(ScreenCases, AcrossTheBorderBehindAWallIsHidden) {
  each_kind([&] {
    Soup screen;  // 33 x 25 pixels from the middle: one more than the screen
    const auto x = static_cast<float>(33 * pixel_at_wall), y = static_cast<float>(25 * pixel_at_wall);
    screen.add_quad({-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0});
    start(screen);
    const double at_bound = pixel_at_wall * 3.5 / 3.0;
    for (const int side : {-1, 1}) {
      EXPECT_EQ(ask(at({side * 32 * at_bound, 0, -0.5F}, 0.2F)), 0U) << side;
      EXPECT_EQ(ask(at({0, side * 24 * at_bound, -0.5F}, 0.2F)), 0U) << side;
    }
  });
}

// The near plane is at z = 2.9. A second wall close to the eye would hide all of these.
TEST_P(ScreenCases, AtTheEyeIsVisible) {
  each_kind([&] {
    Soup close;
    close.add_quad({-1, -1, 2.89F}, {1, -1, 2.89F}, {1, 1, 2.89F}, {-1, 1, 2.89F});
    start(close);
    ASSERT_EQ(ask(at({0, 0, 2.5F}, 0.01F)), 0U);
    EXPECT_EQ(ask(at({0, 0, 2.9F}, 0.05F)), 1U);  // crosses the near plane
    EXPECT_EQ(ask(at({0, 0, 3.0F}, 0.05F)), 1U);  // the eye inside, all before the near plane
    EXPECT_EQ(ask(at({0, 0, 2.0F}, 1.5F)), 1U);   // the eye inside
    EXPECT_EQ(ask(at({0, 0, 4.0F}, 0.5F)), 1U);   // behind the eye: not for the picture to decide
    EXPECT_EQ(ask(at({5, 5, 3.0F}, 0.5F)), 1U);   // beside it
  });
}

// The nearest point is on the near plane itself. Nothing in the picture is nearer, so nothing hides it: neither a wall
// close behind the plane nor one in it.
TEST_P(ScreenCases, TouchingTheNearPlaneIsVisible) {
  each_kind([&] {
    Camera camera = view_.camera();
    camera.near = 0.125;
    view_ = View(camera);
    for (const float wall : {2.87F, 2.875F}) {
      start(wide_wall(wall));
      EXPECT_EQ(ask(at({0, 0, 2.8125F}, 0.0625F)), 1U) << wall;
    }
  });
}

// Depth 10 is the far plane, z = -7. Beyond it the wall still hides, and what is beside the wall is not clipped away:
// the far plane cuts the second bound, and the third is wholly behind it.
TEST_P(ScreenCases, BeyondTheFarPlaneIsNotLost) {
  each_kind([&] {
    EXPECT_EQ(ask(at({0, 0, -7}, 0.5F)), 0U);
    EXPECT_EQ(ask(at({4.5F, 0, -7}, 0.5F)), 1U);
    EXPECT_EQ(ask(at({5.5F, 0, -9}, 0.5F)), 1U);
    // 10,000 times as far, one behind the wall's middle and one 25 pixels from it.
    EXPECT_EQ(ask(at({0, 0, -1e5F}, 1.0F)), 0U);
    EXPECT_EQ(ask(at({static_cast<float>(25 * pixel_at_wall / 3.0 * 1e5), 0, -1e5F}, 1.0F)), 1U);
  });
}

// The occluder covers the screen. What is larger than the screen and in front of it is visible to all; what is behind
// is hidden from an exact rectangle, cut at the image's border, and visible to proxies, which are not drawn so large.
TEST_P(ScreenCases, LargerThanTheScreenIsVisible) {
  each_kind([&] {
    Soup all;
    all.add_quad({-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0});
    start(all);
    EXPECT_EQ(ask(at({0, 0, -3}, 3.5F)), 1U);
    EXPECT_EQ(ask(at({0, 0, -4}, 3.5F)), GetParam().draws_proxies() ? 1U : 0U);
    EXPECT_EQ(ask(at({0, 0, -1}, 0.5F)), 0U);
  });
}

// One pixel, 2.5 units wide at the wall. A proxy grows by 3/4 of it on each side and covers the screen, hence visible
// without a query; an exact rectangle is that pixel, where the wall is.
TEST_P(ScreenCases, AScreenOfOnePixel) {
  each_kind([&] {
    Camera camera = view_.camera();
    camera.width = camera.height = 1;
    view_ = View(camera);
    start(wide_wall(0.0F));
    EXPECT_EQ(ask(at({0.7F, -0.3F, 0.5F}, 0.1F)), 1U);
    EXPECT_EQ(ask(at({0.7F, -0.3F, -0.5F}, 0.1F)), GetParam().draws_proxies() ? 1U : 0U);
    // Twelve pixels beside it. Grown by two or three times as much, a proxy at depth 3.5 reaches the eye.
    if (GetParam().divisor() == 1) {
      EXPECT_EQ(ask(at({30, 0, -0.5F}, 0.1F)), 0U);
    }
  });
}

}  // namespace
}  // namespace occlod::gl
