// One suite over every platform and proxy. The wall hides what is behind it; each case has one right answer by
// geometry.
#include <array>
#include <cmath>
#include <limits>

#include "gl/support.h"

namespace occlod::gl {
namespace {

class QueryCases : public testing::TestWithParam<std::tuple<Platform, ProxyShape>> {
 protected:
  void SetUp() override {
    std::string why;
    context_ = context_or_null(std::get<0>(GetParam()), why);
    if (!context_) GTEST_SKIP() << "no context: " << why;
    occlusion_ = make_query_occlusion(context_);
    start(wall());
  }
  void start(const Soup& occluder, const glm::dmat4& transform = glm::dmat4(1.0)) {
    const std::array<ObjectView, 1> objects{ObjectView(view_, transform)};
    occlusion_->begin_view(view_, objects);
    const std::array<OccluderPart, 1> parts{occluder.part()};
    occlusion_->draw_occluder(parts);
  }
  [[nodiscard]] std::uint32_t ask(const VisibilityQuery& query) {
    occlusion_->submit(query);
    return occlusion_->collect();
  }
  [[nodiscard]] VisibilityQuery at(const glm::vec3& center, float half) const {
    return bound(shape(), center, glm::vec3(half));
  }
  [[nodiscard]] static ProxyShape shape() { return std::get<1>(GetParam()); }

  View view_ = test_view();
  std::shared_ptr<Context> context_;
  std::unique_ptr<Visibility> occlusion_;
};

INSTANTIATE_TEST_SUITE_P(Gl, QueryCases,
                         testing::Combine(testing::Values(Platform::egl, Platform::osmesa),
                                          testing::Values(ProxyShape::sphere, ProxyShape::box, ProxyShape::cylinder)),
                         [](const auto& param) {
                           return platform_label(std::get<0>(param.param)) + "_" +
                                  shape_label(std::get<1>(param.param));
                         });

TEST_P(QueryCases, InFrontIsVisible) { EXPECT_EQ(ask(at({0, 0, 0.5F}, 0.1F)), 1U); }

TEST_P(QueryCases, BehindIsHidden) { EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 0U); }

TEST_P(QueryCases, WithoutAnOccluderAllOnTheScreenIsVisible) {
  const std::array<ObjectView, 1> objects{ObjectView(view_, glm::dmat4(1.0))};
  occlusion_->begin_view(view_, objects);
  EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 1U);
}

TEST_P(QueryCases, ANewOccluderReplacesTheOld) {
  occlusion_->draw_occluder({});
  EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 1U);
}

TEST_P(QueryCases, TheOccludersBackHidesToo) {
  Soup turned = wall();
  for (Triangle& triangle : turned.triangles) std::swap(triangle.y, triangle.z);
  start(turned);
  EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 0U);
}

// From the eye at z = 3, the wall's edge at x = 1 hides up to 1 * 3.5 / 3 = 1.167 in the plane z = -0.5.
TEST_P(QueryCases, AcrossTheEdgeIsVisible) {
  EXPECT_EQ(ask(at({1.167F, 0, -0.5F}, 0.1F)), 1U);
  EXPECT_EQ(ask(at({0, -1.167F, -0.5F}, 0.1F)), 1U);
  EXPECT_EQ(ask(at({0.9F, 0, -0.5F}, 0.1F)), 0U);
}

TEST_P(QueryCases, TouchingFromBehindIsVisible) {
  EXPECT_EQ(ask(at({0.3F, 0.2F, -0.125F}, 0.125F)), 1U);
  EXPECT_EQ(ask(at({0, 0, 0}, 0.0F)), 1U);
}

// With the near plane at 1e-4, one step of a 32-bit depth buffer at depth 100 is 100^2 / 1e-4 * 2^-24 = 6 units: more
// than a proxy grows (0.75 pixels of 100 / 58 units), so rounding alone decides unless depths are biased. Tilted, so
// that neighbouring pixels round differently.
TEST_P(QueryCases, TouchingIsVisibleWhereDepthIsCoarse) {
  Camera camera = view_.camera();
  camera.near = 1e-4;
  camera.far = 1000.0;
  view_ = View(camera);
  Soup tilted;
  tilted.add_quad({-60, -60, -117}, {60, -60, -97}, {60, 60, -77}, {-60, 60, -97});
  start(tilted);
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const float x = uniform(random, -40, 40);
    const float y = uniform(random, -30, 30);
    EXPECT_EQ(ask(at({x, y, -97 + (x + y) / 6}, 0.01F)), 1U) << i;
  }
}

// Wherever in a pixel it lies, with corners and edges of pixels among the places.
TEST_P(QueryCases, SubPixelInFrontIsVisible) {
  for (int i = 0; i < 64; ++i) {
    const float z = 0.01F;
    const auto pixel = static_cast<float>(pixel_at_wall * (3.0 - 0.01) / 3.0);
    const glm::vec3 center(pixel * (3.0F + static_cast<float>(i % 8) / 8.0F),
                           pixel * (-5.0F + static_cast<float>(i - i % 8) / 64.0F), z);
    EXPECT_EQ(ask(at(center, 1e-4F)), 1U) << i;
  }
}

// The hole is pixel [10, 11) x [5, 6) right and up of the middle, so exactly one sample sees through it.
class OnePixelHole : public QueryCases {
 protected:
  static constexpr double x0 = 10 * pixel_at_wall;
  static constexpr double y0 = 5 * pixel_at_wall;
  void SetUp() override {
    QueryCases::SetUp();
    if (IsSkipped()) return;
    start(wall_with_hole(static_cast<float>(x0), static_cast<float>(x0 + pixel_at_wall), static_cast<float>(y0),
                         static_cast<float>(y0 + pixel_at_wall)));
  }
  // The point seen through the wall at pixel coordinates (x, y) from the hole's lower left, at z = -1: depth 4 instead
  // of 3.
  static glm::vec3 behind(double x, double y) {
    return {static_cast<float>((x0 + x * pixel_at_wall) * 4.0 / 3.0),
            static_cast<float>((y0 + y * pixel_at_wall) * 4.0 / 3.0), -1.0F};
  }
};
INSTANTIATE_TEST_SUITE_P(Gl, OnePixelHole,
                         testing::Combine(testing::Values(Platform::egl, Platform::osmesa),
                                          testing::Values(ProxyShape::sphere, ProxyShape::box, ProxyShape::cylinder)),
                         [](const auto& param) {
                           return platform_label(std::get<0>(param.param)) + "_" +
                                  shape_label(std::get<1>(param.param));
                         });

TEST_P(OnePixelHole, ShowsWhatIsBehindIt) {
  EXPECT_EQ(ask(at(behind(0.5, 0.5), 0.2F)), 1U);
  // Three pixels beside the hole: farther than a proxy may grow.
  EXPECT_EQ(ask(at(behind(4.0, 0.5), 1e-4F)), 0U);
  EXPECT_EQ(ask(at(behind(0.5, -3.0), 1e-4F)), 0U);
}

// A bound no larger than a hundredth of a pixel in the last corners of the hole's pixel touches that pixel, 0.7 pixels
// from its sample. A proxy grown by less would miss it.
TEST_P(OnePixelHole, ShowsWhatTouchesTheCornersOfItsPixel) {
  for (const double x : {0.01, 0.99})
    for (const double y : {0.01, 0.99}) EXPECT_EQ(ask(at(behind(x, y), 1e-5F)), 1U) << x << " " << y;
}

TEST_P(QueryCases, OffTheScreenIsHidden) { EXPECT_EQ(ask(at({3, 0, 0}, 0.1F)), 0U); }

// The near plane is at z = 2.9. A second wall close to the eye would hide all of these.
TEST_P(QueryCases, AtTheEyeIsVisible) {
  Soup close;
  close.add_quad({-1, -1, 2.89F}, {1, -1, 2.89F}, {1, 1, 2.89F}, {-1, 1, 2.89F});
  start(close);
  ASSERT_EQ(ask(at({0, 0, 2.5F}, 0.01F)), 0U);
  EXPECT_EQ(ask(at({0, 0, 2.9F}, 0.05F)), 1U);  // crosses the near plane
  EXPECT_EQ(ask(at({0, 0, 3.0F}, 0.05F)), 1U);  // the eye inside, all before the near plane
  EXPECT_EQ(ask(at({0, 0, 2.0F}, 1.5F)), 1U);   // the eye inside
}

// What the near plane cuts away of the occluder is not in the picture and hides nothing.
TEST_P(QueryCases, AnOccluderBeforeTheNearPlaneHidesNothing) {
  Soup close;
  close.add_quad({-1, -1, 2.95F}, {1, -1, 2.95F}, {1, 1, 2.95F}, {-1, 1, 2.95F});
  start(close);
  EXPECT_EQ(ask(at({0, 0, 0}, 0.1F)), 1U);
}

// Depth 10 is the far plane, z = -7. Beyond it the wall still hides, and what is beside the wall is not clipped away:
// the far plane cuts the second bound, and the third is wholly behind it.
TEST_P(QueryCases, BeyondTheFarPlaneIsNotLost) {
  EXPECT_EQ(ask(at({0, 0, -7}, 0.5F)), 0U);
  EXPECT_EQ(ask(at({4.5F, 0, -7}, 0.5F)), 1U);
  EXPECT_EQ(ask(at({5.5F, 0, -9}, 0.5F)), 1U);
}

TEST_P(QueryCases, LargerThanTheScreenIsVisible) {
  Soup all;
  all.add_quad({-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0});
  start(all);
  EXPECT_EQ(ask(at({0, 0, -4}, 3.5F)), 1U);
  EXPECT_EQ(ask(at({0, 0, -1}, 0.5F)), 0U);
}

TEST_P(QueryCases, NotFiniteIsVisible) {
  EXPECT_EQ(ask(at({0, std::numeric_limits<float>::quiet_NaN(), -0.5F}, 0.1F)), 1U);
  EXPECT_EQ(ask(at({0, 0, -0.5F}, std::numeric_limits<float>::infinity())), 1U);
}

// Mirroring swaps front and back faces; the answers must not change. So with scales that differ by axis.
TEST_P(QueryCases, TransformedObjectsAnswerAlike) {
  for (const glm::dvec3 scale :
       {glm::dvec3(-1, 1, 1), glm::dvec3(1, 1, -1), glm::dvec3(-2, -0.5, -4), glm::dvec3(0.5, 3, 0.4)}) {
    const glm::dmat4 transform = glm::scale(glm::dmat4(1.0), scale);
    // The wall stands in z = 0 before and after; it covers at least |x|, |y| <= 0.4 when it is scaled back.
    Soup soup = wall();
    for (glm::vec3& p : soup.positions) p = glm::vec3(glm::dvec3(p) / scale);
    start(soup, transform);
    const auto placed = [&](double z) {
      const glm::vec3 center(0.0F, 0.0F, static_cast<float>(z / scale.z));
      return bound(shape(), center, glm::vec3(glm::dvec3(0.1) / glm::abs(scale)));
    };
    EXPECT_EQ(ask(placed(0.5)), 1U);
    EXPECT_EQ(ask(placed(-0.5)), 0U);
  }
}

TEST_P(QueryCases, PointsAreAskedAboutByTheirBox) {
  const std::array<glm::vec3, 2> behind{glm::vec3(-0.1F, 0, -0.5F), glm::vec3(0.1F, 0.1F, -0.4F)};
  const std::array<glm::vec3, 2> across{glm::vec3(-0.1F, 0, -0.5F), glm::vec3(0.1F, 0.1F, 0.1F)};
  EXPECT_EQ(ask({0, PointHull{behind}}), 0U);
  EXPECT_EQ(ask({0, PointHull{across}}), 1U);
}

// The face towards the eye is 10 x 10 pixels, at whole pixels, in front of the wall. Grown by 0.708 to 1 pixel on each
// side (1.1 for the depth of the proxy and 1.23 and 1.02 for circumscribing), the count lies between what is certainly
// covered and what can be.
TEST_P(QueryCases, CountsPixels) {
  occlusion_ = make_query_occlusion(context_, {.flight = 1, .count_pixels = true});
  start(wall());
  const auto half = static_cast<float>(5 * pixel_at_wall * 2.5 / 3.0);
  const std::uint32_t front = ask(bound(shape(), {0, 0, 0.5F}, {half, half, half}));
  const double exact = shape() == ProxyShape::box ? 100.0 : 25.0 * 3.14159;
  const double side = 2.0 * (5.0 * 1.25 * 2.5 / (2.5 - half) + 1.0);
  EXPECT_GE(front, exact);
  EXPECT_LE(front, side * side);
  EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 0U);
  // Nothing is known about this one, so it may fill the image.
  EXPECT_EQ(ask(at({0, 0, 3}, 0.1F)), 64U * 48U);
}

}  // namespace
}  // namespace occlod::gl
