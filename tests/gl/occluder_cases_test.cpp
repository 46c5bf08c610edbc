// What hides and what does not: occluders in every place and shape before, around and behind the eye.
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "gl/backend_cases.h"

namespace occlod::gl {
namespace {

class OccluderCases : public BackendCases {};
INSTANTIATE_TEST_SUITE_P(Gl, OccluderCases, testing::ValuesIn(tested_backends()), backend_label);

TEST_P(OccluderCases, InFrontIsVisible) {
  each_kind([&] { EXPECT_EQ(ask(at({0, 0, 0.5F}, 0.1F)), 1U); });
}

TEST_P(OccluderCases, BehindIsHidden) {
  each_kind([&] { EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 0U); });
}

TEST_P(OccluderCases, WithoutAnOccluderAllOnTheScreenIsVisible) {
  each_kind([&] {
    const std::array<ObjectView, 1> objects{ObjectView(view_, glm::dmat4(1.0))};
    occlusion_->begin_view(view_, objects);
    EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 1U);
  });
}

TEST_P(OccluderCases, ANewOccluderReplacesTheOld) {
  each_kind([&] {
    occlusion_->draw_occluder({});
    EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 1U);
  });
}

// Triangles without an area cover no pixel's centre, and a part without triangles has nothing to draw.
TEST_P(OccluderCases, EmptyOccludersHideNothing) {
  each_kind([&] {
    Soup nothing = wall();
    nothing.triangles.clear();
    start(nothing);
    EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 1U);
    Soup flat = wall();
    flat.triangles = {{0, 0, 1}, {2, 2, 2}, {0, 1, 0}};
    flat.positions.insert(flat.positions.end(), {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}});
    flat.triangles.emplace_back(4, 5, 6);
    start(flat);
    EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 1U);
  });
}

TEST_P(OccluderCases, TheOccludersBackHidesToo) {
  each_kind([&] {
    Soup turned = wall();
    for (Triangle& triangle : turned.triangles) std::swap(triangle.y, triangle.z);
    start(turned);
    EXPECT_EQ(ask(at({0, 0, -0.5F}, 0.1F)), 0U);
  });
}

// From the eye at z = 3, the wall's edge at x = 1 hides up to 1 * 3.5 / 3 = 1.167 in the plane z = -0.5.
TEST_P(OccluderCases, AcrossTheEdgeIsVisible) {
  each_kind([&] {
    EXPECT_EQ(ask(at({1.167F, 0, -0.5F}, 0.1F)), 1U);
    EXPECT_EQ(ask(at({0, -1.167F, -0.5F}, 0.1F)), 1U);
    EXPECT_EQ(ask(at({0.7F, 0, -0.5F}, 0.1F)), 0U);
  });
}

TEST_P(OccluderCases, TouchingFromBehindIsVisible) {
  each_kind([&] {
    EXPECT_EQ(ask(at({0.3F, 0.2F, -0.125F}, 0.125F)), 1U);
    EXPECT_EQ(ask(at({0, 0, 0}, 0.0F)), 1U);
  });
}

// With the near plane at 1e-4, one step of a 32-bit depth buffer at depth 100 is 100^2 / 1e-4 * 2^-24 = 6 units: more
// than a proxy grows (0.75 pixels of 100 / 58 units), so rounding alone decides unless depths are biased. Tilted, so
// that neighbouring pixels round differently. A bound of 0.01 touches the wall beside its pixel's sample, which shows
// in grown proxies only; one of 0.5 stands out farther than the wall rises within half a pixel, 0.86 / 3 units.
TEST_P(OccluderCases, TouchingIsVisibleWhereDepthIsCoarse) {
  each_kind([&] {
    Camera camera = view_.camera();
    camera.near = 1e-4;
    camera.far = 1000.0;
    view_ = View(camera);
    Soup tilted;
    tilted.add_quad({-60, -60, -117}, {60, -60, -97}, {60, 60, -77}, {-60, 60, -97});
    start(tilted);
    const float half = GetParam().draws_proxies() ? 0.01F : 0.5F;
    test::RandomShapes random(5);
    for (int i = 0; i < 200; ++i) {
      const auto x = static_cast<float>(random.in(-40.0, 40.0));
      const auto y = static_cast<float>(random.in(-30.0, 30.0));
      EXPECT_EQ(ask(at({x, y, -97 + (x + y) / 6}, half)), 1U) << i;
    }
  });
}

// A point on a triangle that rises by up to a tenth of its inverse depth in each pixel, at the pixel's centre. A driver
// that moves corners by 1/512 pixel (llvmpipe does not) draws the triangle up to 2e-4 nearer half of the time: their
// occluders are pushed away by more. `software` moves corners and pushes nothing: there the point is in front by what
// 1/128 pixel spans.
TEST_P(OccluderCases, TouchingASteepTriangleIsVisible) {
  test::RandomShapes random(6);
  const double focal = view_.focal_length_px();
  for (int i = 0; i < 200; ++i) {
    const double column = 4.5 + random.below(56);
    const glm::dvec2 center(column, 4.5 + random.below(40));
    const double w = random.in(1.0, 6.0);
    const glm::dvec2 slope(random.point(0.1));
    const auto on_plane = [&](const glm::dvec2& offset, double nearer) {
      const double depth = w / (1.0 + slope.x * offset.x + slope.y * offset.y + nearer);
      const glm::dvec2 pixel = center + offset - glm::dvec2(32.0, 24.0);
      return glm::vec3(glm::dvec3(pixel * depth / focal, 3.0 - depth));
    };
    Soup triangle;
    const double turn = random.in(0.0, 6.0);
    for (int k = 0; k < 3; ++k) {
      const double angle = turn + k * 2.0 * std::numbers::pi / 3.0;
      triangle.positions.push_back(on_plane(random.in(3.0, 4.0) * glm::dvec2(std::cos(angle), std::sin(angle)), 0.0));
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

// Two objects whose matrices are rounded differently: the eye is 40 units from their origins and the point 0.1 from the
// eye, so that single-precision coordinates (up to 40 / 0.3 with these scales) move it by up to 2e-4 of its depth. The
// sphere is five times as much nearer than the wall of the other object, and a proxy grows by 3e-4 in so narrow a view.
// z and w of a single-precision matrix that know nothing of each other differ by 40 * 2^-24 / 0.1 = 2e-5, which is 400
// steps of the depth buffer, each of 0.1 / near * 2^-24 = 2e-5 of that depth.
TEST_P(OccluderCases, ObjectsAgreeAboutDepth) {
  test::RandomShapes random(7);
  for (int i = 0; i < 300; ++i) {
    Camera camera = view_.camera();
    camera.eye = 40.0 * random.unit();
    camera.target = camera.eye + random.unit();
    camera.up = random.unit();
    camera.fov_y_deg = 1.0;
    camera.near = 2.8e-4;
    camera.far = 55.0;
    const View view(camera);
    const std::array<glm::dmat4, 2> to_world{random.linear(), random.linear()};
    const auto placed = [&](std::size_t object, double depth, double x, double y) {
      const glm::dvec3 right = glm::normalize(glm::cross(view.direction(), camera.up));
      const glm::dvec3 up = glm::cross(right, view.direction());
      const glm::dvec3 world = camera.eye + depth * view.direction() + x * right + y * up;
      return glm::vec3(glm::inverse(to_world[object]) * glm::dvec4(world, 1.0));
    };
    const std::array<ObjectView, 2> objects{ObjectView(view, to_world[0]), ObjectView(view, to_world[1])};
    occlusion_->begin_view(view, objects);
    Soup other;
    other.add_quad(placed(1, 0.1, -1, -1), placed(1, 0.1, 1, -1), placed(1, 0.1, 1, 1), placed(1, 0.1, -1, 1));
    occlusion_->draw_occluder(std::array{other.part(1)});
    EXPECT_EQ(ask({0, Sphere{placed(0, 0.1 * (1.0 - 1e-3), 0.0, 0.0), 0.0F}}), 1U) << i;
    EXPECT_EQ(ask({0, Sphere{placed(0, 0.15, 0.0, 0.0), 0.0F}}), 0U) << i;
  }
}

// What the near plane cuts away of the occluder is not in the picture and hides nothing.
TEST_P(OccluderCases, AnOccluderBeforeTheNearPlaneHidesNothing) {
  each_kind([&] {
    Soup close;
    close.add_quad({-1, -1, 2.95F}, {1, -1, 2.95F}, {1, 1, 2.95F}, {-1, 1, 2.95F});
    start(close);
    EXPECT_EQ(ask(at({0, 0, 0}, 0.1F)), 1U);
  });
}

TEST_P(OccluderCases, AnOccluderBehindTheEyeHidesNothing) {
  each_kind([&] {
    start(wide_wall(4.0F));
    EXPECT_EQ(ask(at({0, 0, 0}, 0.1F)), 1U);
    EXPECT_EQ(ask(at({0.5F, -0.5F, -3}, 0.1F)), 1U);
  });
}

// A slope that falls away from the eye, from behind it to the far plane: at depth d it is 0.02 + 0.02 (d - 0.1) below
// the axis. The near plane at depth 0.1 cuts it where y / d = -0.2, so on the screen it covers -0.2 to -0.02. At depth
// 2, y = -0.2 is below it and seen through it; y = -0.6 is seen under the cut, and y = 0.2 above the slope.
TEST_P(OccluderCases, AnOccluderAcrossTheNearPlaneHidesAsFarAsItIsSeen) {
  each_kind([&] {
    Soup slope;
    const auto height = [](float z) { return -0.02F - 0.02F * (2.9F - z); };
    slope.add_quad({-3, height(5), 5}, {3, height(5), 5}, {3, height(-7), -7}, {-3, height(-7), -7});
    start(slope);
    EXPECT_EQ(ask(at({0, -0.2F, 1}, 0.01F)), 0U);
    EXPECT_EQ(ask(at({0, -0.6F, 1}, 0.01F)), 1U);
    EXPECT_EQ(ask(at({0, 0.2F, 1}, 0.01F)), 1U);
  });
}

}  // namespace
}  // namespace occlod::gl
