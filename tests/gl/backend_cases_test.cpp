// One suite over every platform and proxy. The wall hides what is behind it; each case has one right answer by
// geometry.
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "gl/backends.h"

namespace occlod::gl {
namespace {

class BackendCases : public EachBackend {
 protected:
  void SetUp() override {
    EachBackend::SetUp();
    if (!IsSkipped()) occlusion_ = make();
  }
  // Runs `body` for each kind of bound, each time with the wall as the occluder.
  template <class Body>
  void each_shape(Body body) {
    for (const ProxyShape shape : {ProxyShape::sphere, ProxyShape::box, ProxyShape::cylinder}) {
      SCOPED_TRACE(shape_label(shape));
      shape_ = shape;
      view_ = test_view();
      start(wall());
      body();
    }
  }
  void start(const Soup& occluder, const glm::dmat4& transform = glm::dmat4(1.0)) {
    EachBackend::start(*occlusion_, occluder, transform);
  }
  [[nodiscard]] std::uint32_t ask(const VisibilityQuery& query) {
    occlusion_->submit(query);
    return occlusion_->collect();
  }
  [[nodiscard]] VisibilityQuery at(const glm::vec3& center, float half) const {
    return bound(shape_, center, glm::vec3(half));
  }

  std::unique_ptr<Visibility> occlusion_;
  ProxyShape shape_ = ProxyShape::box;
};

INSTANTIATE_TEST_SUITE_P(Gl, BackendCases, testing::ValuesIn(tested_backends()), backend_label);

TEST_P(BackendCases, InFrontIsVisible) {
  each_shape([&] { EXPECT_EQ(ask(at({0, 0, 0.5F}, 0.1F)), 1U); });
}

TEST_P(BackendCases, BehindIsHidden) {
  each_shape([&] { EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 0U); });
}

TEST_P(BackendCases, WithoutAnOccluderAllOnTheScreenIsVisible) {
  each_shape([&] {
    const std::array<ObjectView, 1> objects{ObjectView(view_, glm::dmat4(1.0))};
    occlusion_->begin_view(view_, objects);
    EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 1U);
  });
}

TEST_P(BackendCases, ANewOccluderReplacesTheOld) {
  each_shape([&] {
    occlusion_->draw_occluder({});
    EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 1U);
  });
}

TEST_P(BackendCases, TheOccludersBackHidesToo) {
  each_shape([&] {
    Soup turned = wall();
    for (Triangle& triangle : turned.triangles) std::swap(triangle.y, triangle.z);
    start(turned);
    EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 0U);
  });
}

// From the eye at z = 3, the wall's edge at x = 1 hides up to 1 * 3.5 / 3 = 1.167 in the plane z = -0.5.
TEST_P(BackendCases, AcrossTheEdgeIsVisible) {
  each_shape([&] {
    EXPECT_EQ(ask(at({1.167F, 0, -0.5F}, 0.1F)), 1U);
    EXPECT_EQ(ask(at({0, -1.167F, -0.5F}, 0.1F)), 1U);
    EXPECT_EQ(ask(at({0.7F, 0, -0.5F}, 0.1F)), 0U);
  });
}

TEST_P(BackendCases, TouchingFromBehindIsVisible) {
  each_shape([&] {
    EXPECT_EQ(ask(at({0.3F, 0.2F, -0.125F}, 0.125F)), 1U);
    EXPECT_EQ(ask(at({0, 0, 0}, 0.0F)), 1U);
  });
}

// With the near plane at 1e-4, one step of a 32-bit depth buffer at depth 100 is 100^2 / 1e-4 * 2^-24 = 6 units: more
// than a proxy grows (0.75 pixels of 100 / 58 units), so rounding alone decides unless depths are biased. Tilted, so
// that neighbouring pixels round differently. A bound of 0.01 touches the wall beside its pixel's sample, which shows
// in grown proxies only; one of 0.5 stands out farther than the wall rises within half a pixel, 0.86 / 3 units.
TEST_P(BackendCases, TouchingIsVisibleWhereDepthIsCoarse) {
  each_shape([&] {
    Camera camera = view_.camera();
    camera.near = 1e-4;
    camera.far = 1000.0;
    view_ = View(camera);
    Soup tilted;
    tilted.add_quad({-60, -60, -117}, {60, -60, -97}, {60, 60, -77}, {-60, 60, -97});
    start(tilted);
    const float half = GetParam().draws_proxies() ? 0.01F : 0.5F;
    std::mt19937 random(5);
    for (int i = 0; i < 200; ++i) {
      const float x = uniform(random, -40, 40);
      const float y = uniform(random, -30, 30);
      EXPECT_EQ(ask(at({x, y, -97 + (x + y) / 6}, half)), 1U) << i;
    }
  });
}

// A point on a triangle that rises by up to a tenth of its inverse depth in each pixel, at the pixel's centre. A driver
// that moves corners by 1/512 pixel (llvmpipe does not) draws the triangle up to 2e-4 nearer half of the time: their
// occluders are pushed away by more. `software` moves corners and pushes nothing: there the point is in front by what
// 1/128 pixel spans.
TEST_P(BackendCases, TouchingASteepTriangleIsVisible) {
  std::mt19937 random(6);
  const double focal = view_.focal_length_px();
  for (int i = 0; i < 200; ++i) {
    const glm::dvec2 center(4.0 + static_cast<double>(random() % 56U) + 0.5,
                            4.0 + static_cast<double>(random() % 40U) + 0.5);
    const double w = uniform(random, 1, 6);
    const glm::dvec2 slope(uniform(random, -0.1F, 0.1F), uniform(random, -0.1F, 0.1F));
    const auto on_plane = [&](const glm::dvec2& offset, double nearer) {
      const double depth = w / (1.0 + slope.x * offset.x + slope.y * offset.y + nearer);
      const glm::dvec2 pixel = center + offset - glm::dvec2(32.0, 24.0);
      return glm::vec3(glm::dvec3(pixel * depth / focal, 3.0 - depth));
    };
    Soup triangle;
    const double turn = uniform(random, 0, 6);
    for (int k = 0; k < 3; ++k) {
      const double angle = turn + k * 2.0 * std::numbers::pi / 3.0;
      triangle.positions.push_back(
          on_plane(double{uniform(random, 3, 4)} * glm::dvec2(std::cos(angle), std::sin(angle)), 0.0));
    }
    triangle.triangles.emplace_back(0, 1, 2);
    start(triangle);
    const bool pushed = GetParam().backend != Backend::software;
    const double nearer = pushed ? 0.0 : (std::abs(slope.x) + std::abs(slope.y)) / 128.0;
    EXPECT_EQ(ask({0, Sphere{on_plane({0, 0}, nearer), 0.0F}}), 1U) << i;
    // Twice as far away, the triangle hides it from all samples that are its own pixel's alone.
    if (GetParam().divisor() == 1) {
      EXPECT_EQ(ask({0, Sphere{on_plane({0, 0}, -0.5), 0.0F}}), 0U) << i;
    }
  }
}

// Wherever in a pixel it lies, with corners and edges of pixels among the places.
TEST_P(BackendCases, SubPixelInFrontIsVisible) {
  each_shape([&] {
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
  each_shape([&] {
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
  each_shape([&] {
    for (int hole = 0; hole < 9; ++hole) {
      start_hole(hole % 3, hole / 3);
      for (const double x : {0.01, 0.99})
        for (const double y : {0.01, 0.99}) EXPECT_EQ(ask(at(behind(x, y), 1e-5F)), 1U) << hole << " " << x << " " << y;
    }
  });
}

TEST_P(BackendCases, OffTheScreenIsHidden) {
  each_shape([&] { EXPECT_EQ(ask(at({3, 0, 0}, 0.1F)), 0U); });
}

// The near plane is at z = 2.9. A second wall close to the eye would hide all of these.
TEST_P(BackendCases, AtTheEyeIsVisible) {
  each_shape([&] {
    Soup close;
    close.add_quad({-1, -1, 2.89F}, {1, -1, 2.89F}, {1, 1, 2.89F}, {-1, 1, 2.89F});
    start(close);
    ASSERT_EQ(ask(at({0, 0, 2.5F}, 0.01F)), 0U);
    EXPECT_EQ(ask(at({0, 0, 2.9F}, 0.05F)), 1U);  // crosses the near plane
    EXPECT_EQ(ask(at({0, 0, 3.0F}, 0.05F)), 1U);  // the eye inside, all before the near plane
    EXPECT_EQ(ask(at({0, 0, 2.0F}, 1.5F)), 1U);   // the eye inside
  });
}

// What the near plane cuts away of the occluder is not in the picture and hides nothing.
TEST_P(BackendCases, AnOccluderBeforeTheNearPlaneHidesNothing) {
  each_shape([&] {
    Soup close;
    close.add_quad({-1, -1, 2.95F}, {1, -1, 2.95F}, {1, 1, 2.95F}, {-1, 1, 2.95F});
    start(close);
    EXPECT_EQ(ask(at({0, 0, 0}, 0.1F)), 1U);
  });
}

// Depth 10 is the far plane, z = -7. Beyond it the wall still hides, and what is beside the wall is not clipped away:
// the far plane cuts the second bound, and the third is wholly behind it.
TEST_P(BackendCases, BeyondTheFarPlaneIsNotLost) {
  each_shape([&] {
    EXPECT_EQ(ask(at({0, 0, -7}, 0.5F)), 0U);
    EXPECT_EQ(ask(at({4.5F, 0, -7}, 0.5F)), 1U);
    EXPECT_EQ(ask(at({5.5F, 0, -9}, 0.5F)), 1U);
  });
}

// The occluder covers the screen. What is larger than the screen and in front of it is visible to all; what is behind
// is hidden from an exact rectangle, cut at the image's border, and visible to proxies, which are not drawn so large.
TEST_P(BackendCases, LargerThanTheScreenIsVisible) {
  each_shape([&] {
    Soup all;
    all.add_quad({-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0});
    start(all);
    EXPECT_EQ(ask(at({0, 0, -3}, 3.5F)), 1U);
    EXPECT_EQ(ask(at({0, 0, -4}, 3.5F)), GetParam().draws_proxies() ? 1U : 0U);
    EXPECT_EQ(ask(at({0, 0, -1}, 0.5F)), 0U);
  });
}

TEST_P(BackendCases, NotFiniteIsVisible) {
  each_shape([&] {
    EXPECT_EQ(ask(at({0, std::numeric_limits<float>::quiet_NaN(), -0.5F}, 0.1F)), 1U);
    EXPECT_EQ(ask(at({0, 0, -0.5F}, std::numeric_limits<float>::infinity())), 1U);
  });
}

// Mirroring swaps front and back faces; the answers must not change. So with scales that differ by axis.
TEST_P(BackendCases, TransformedObjectsAnswerAlike) {
  each_shape([&] {
    for (const glm::dvec3 scale :
         {glm::dvec3(-1, 1, 1), glm::dvec3(1, 1, -1), glm::dvec3(-2, -0.5, -4), glm::dvec3(0.5, 3, 0.4)}) {
      const glm::dmat4 transform = glm::scale(glm::dmat4(1.0), scale);
      // The wall stands in z = 0 before and after; it covers at least |x|, |y| <= 0.4 when it is scaled back.
      Soup soup = wall();
      for (glm::vec3& p : soup.positions) p = glm::vec3(glm::dvec3(p) / scale);
      start(soup, transform);
      const auto placed = [&](double z) {
        const glm::vec3 center(0.0F, 0.0F, static_cast<float>(z / scale.z));
        return bound(shape_, center, glm::vec3(glm::dvec3(0.1) / glm::abs(scale)));
      };
      EXPECT_EQ(ask(placed(0.5)), 1U);
      // Grown by samples of several pixels, a proxy that is stretched eightfold reaches through the wall.
      if (GetParam().divisor() == 1 || scale.x * scale.y * scale.z == -1.0) {
        EXPECT_EQ(ask(placed(-0.5)), 0U);
      }
    }
  });
}

TEST_P(BackendCases, PointsAreAskedAboutByTheirBox) {
  each_shape([&] {
    const std::array<glm::vec3, 2> behind{glm::vec3(-0.1F, 0, -0.5F), glm::vec3(0.1F, 0.1F, -0.4F)};
    const std::array<glm::vec3, 2> across{glm::vec3(-0.1F, 0, -0.5F), glm::vec3(0.1F, 0.1F, 0.1F)};
    EXPECT_EQ(ask({0, PointHull{behind}}), 0U);
    EXPECT_EQ(ask({0, PointHull{across}}), 1U);
  });
}

// The face towards the eye is 10 x 10 pixels, at whole pixels, in front of the wall. Grown by 0.708 to 1 sample on each
// side (1.1 for the depth of the proxy and 1.23 and 1.02 for circumscribing), the count lies between what is certainly
// covered and what can be; a sample counts for all its pixels.
TEST_P(BackendCases, CountsPixels) {
  occlusion_ = make(true);
  each_shape([&] {
    const auto half = static_cast<float>(5 * pixel_at_wall * 2.5 / 3.0);
    const std::uint32_t front = ask(bound(shape_, {0, 0, 0.5F}, {half, half, half}));
    const double exact = shape_ == ProxyShape::box ? 100.0 : 25.0 * 3.14159;
    const int divisor = GetParam().divisor();
    const double side = 2.0 * (5.0 * 1.25 * 2.5 / (2.5 - half) + divisor) + 2.0 * (divisor - 1);
    EXPECT_GE(front, exact);
    EXPECT_LE(front, side * side);
    EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 0U);
    // Nothing is known about this one, so it may fill the image.
    EXPECT_EQ(ask(at({0, 0, 3}, 0.1F)), 64U * 48U);
  });
}

// A bound over half of the wall's right edge, at z = -0.5: the edge hides up to x = 1.167, 1 / pixel_at_wall = 19.3
// pixels from the middle, so of the box from x = 0.9 to 1.4 about half is counted, and all of it when nothing is drawn.
TEST_P(BackendCases, CountsOnlyWhatIsVisible) {
  occlusion_ = make(true);
  each_shape([&] {
    const VisibilityQuery across = at({1.15F, 0, -0.5F}, 0.25F);
    const std::uint32_t some = ask(across);
    occlusion_->draw_occluder({});
    const std::uint32_t all = ask(across);
    EXPECT_GT(some, all / 5);
    EXPECT_LT(some, all * 4 / 5);
  });
}

}  // namespace
}  // namespace occlod::gl
