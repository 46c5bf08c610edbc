#include <gtest/gtest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "occlod/base.h"
#include "occlod/cell_builder.h"
#include "oracle/random_shapes.h"

namespace occlod {
namespace {

constexpr EyeModel eyes{.focal_length_px = 100.0, .cos_corner_angle = 0.5, .near = 0.1, .clearance = 0.0};
constexpr CellBox point{};
constexpr CellBox cube{glm::dvec3(-1.0), glm::dvec3(1.0)};

// f / (D cos^2 a), D to the nearest point of the sphere: 100 / (4 / 4).
TEST(CellScale, OfAPoint) {
  const CellView view(point, eyes, glm::dmat4(1.0));
  EXPECT_NEAR(view.largest_scale_px(Sphere{{0, 0, -5}, 1.0F}), 100.0F, 1e-4F);
  EXPECT_NEAR(view.largest_scale_px(Box{{-1, -1, -5}, {1, 1, -4}}), 100.0F, 1e-4F);
}

// From the nearest point of the cell: 100 / (3 / 4). The point of the box that is farthest from any eye is
// (1, 1, -5), from (-1, -1, 1).
TEST(CellScale, OfACube) {
  const CellView view(cube, eyes, glm::dmat4(1.0));
  EXPECT_NEAR(view.largest_scale_px(Sphere{{0, 0, -5}, 1.0F}), 400.0F / 3.0F, 1e-4F);
  EXPECT_NEAR(view.smallest_scale_px(Box{{-1, -1, -5}, {1, 1, -4}}), 400.0 / std::sqrt(4.0 + 4.0 + 36.0), 1e-6);
}

// What is seen is beyond the near plane: f / (near cos a), also where an eye is inside the bounds.
TEST(CellScale, IsFiniteInsideTheCell) {
  const CellView view(cube, eyes, glm::dmat4(1.0));
  EXPECT_NEAR(view.largest_scale_px(Sphere{{0, 0, 0}, 1.0F}), 2000.0F, 1e-2F);
  EXPECT_NEAR(view.largest_scale_px(Sphere{{0, 0, 1.5F}, 1.0F}), 2000.0F, 1e-2F);
  EXPECT_NEAR(view.largest_scale_px(Sphere{{0, 0, 2.01F}, 1.0F}), 2000.0F, 1e-2F);  // 0.01 beside it: not 40,000
}

TEST(CellScale, ClearanceBoundsIt) {
  EyeModel clear = eyes;
  clear.clearance = 2.0;
  EXPECT_NEAR(CellView(cube, clear, glm::dmat4(1.0)).largest_scale_px(Sphere{{0, 0, 0}, 1.0F}), 200.0F, 1e-3F);
}

// Three times as large and as far: three times the pixels of a third of the scale.
TEST(CellScale, CountsObjectUnits) {
  const CellView view(point, eyes, glm::scale(glm::dmat4(1.0), glm::dvec3(3.0)));
  EXPECT_NEAR(view.largest_scale_px(Sphere{{0, 0, -5}, 1.0F}), 100.0F, 1e-4F);
}

// A line of sight from which the direction is no farther than the corners of the image.
glm::dvec3 line_of_sight(const glm::dvec3& direction, test::RandomShapes& random) {
  const glm::dvec3 side = glm::normalize(glm::cross(direction, random.unit()));
  const double angle = random.in(0.0, 1.0) * std::acos(eyes.cos_corner_angle);
  return std::cos(angle) * direction + std::sin(angle) * side;
}

// Pixels between the images of p and p + step, for a step without end.
double moved_px(const glm::dvec3& p, const glm::dvec3& step, const glm::dvec3& eye, const glm::dvec3& ahead) {
  const auto image = [&](const glm::dvec3& q) {
    const glm::dvec3 d = q - eye;
    return eyes.focal_length_px * (d / glm::dot(d, ahead) - ahead);
  };
  return glm::length(image(p + 1e-6 * step) - image(p - 1e-6 * step)) / 2e-6;
}

TEST(CellScale, HoldsForRandomEyes) {
  test::RandomShapes random(3);
  double tightest = 0.0;
  for (int n = 0; n < 20'000; ++n) {
    const glm::dvec3 center = random.point(2.0), half = glm::abs(random.point(random.in(0.0, 1.0)));
    const CellBox cell{center - half, center + half};
    const glm::dmat4 to_world = random.placement();
    const Sphere sphere{glm::vec3(random.point(4.0)), static_cast<float>(random.in(0.0, 0.5))};
    const double scale = CellView(cell, eyes, to_world).largest_scale_px(sphere);
    EXPECT_TRUE(std::isfinite(scale));
    const glm::dvec3 eye = glm::mix(cell.min, cell.max, glm::dvec3(random.in(0, 1), random.in(0, 1), random.in(0, 1)));
    const glm::dvec3 p =
        glm::dvec3(sphere.center) + random.in(0.0, 1.0) * static_cast<double>(sphere.radius) * random.unit();
    const glm::dvec3 at = to_world * glm::dvec4(p, 1.0), step = glm::dmat3(to_world) * random.unit();
    if (glm::distance(at, eye) < 1e-3) continue;
    const glm::dvec3 ahead = line_of_sight(glm::normalize(at - eye), random);
    if (glm::dot(at - eye, ahead) < eyes.near) continue;
    const double px = moved_px(at, step, eye, ahead);
    EXPECT_LE(px, scale * (1.0 + 1e-4));
    tightest = std::max(tightest, px / scale);
  }
  EXPECT_GT(tightest, 0.8);  // so half of it would not hold
}

// The plane n.x = d turns its back on an eye iff n.eye < d. The corner of the cube that n points to has n.x = 3, all
// others 1 or less: so each corner decides once.
TEST(CellFacing, EachCornerCounts) {
  const CellView view(cube, eyes, glm::dmat4(1.0));
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 n((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    const glm::dvec3 u = glm::normalize(glm::cross(n, glm::dvec3(0.3, 0.5, -0.8))),
                     v = glm::normalize(glm::cross(n, u));
    for (const double d : {2.999, 3.001}) {
      const glm::dvec3 at = d / 3.0 * n;
      const bool away = d > 3.0;
      EXPECT_EQ(view.faces_away(glm::vec3(at), glm::vec3(at + 0.5 * u), glm::vec3(at + 0.5 * v)), away) << i;
      const NormalCone cone{glm::vec3(glm::normalize(n)), 1.0F};
      EXPECT_EQ(view.faces_away(cone, Sphere{glm::vec3(at), 0.0F}), away) << i;
    }
  }
}

// Whatever is called a back shows its back to every eye; what shows it to all corners is called one.
TEST(CellFacing, OfRandomTriangles) {
  test::RandomShapes random(5);
  int away = 0, towards = 0;
  for (int n = 0; n < 20'000; ++n) {
    const glm::dvec3 center = random.point(1.0), half = glm::abs(random.point(1.0));
    const CellBox cell{center - half, center + half};
    const glm::dmat4 to_world = random.placement();
    const CellView view(cell, eyes, to_world);
    const glm::vec3 a(random.point(3.0)), b(random.point(3.0)), c(random.point(3.0));
    const glm::dvec3 normal = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
    // The winding in object space decides, also under mirrors.
    const glm::dmat4 to_object = glm::inverse(to_world);
    const auto front = [&](const glm::dvec3& share) {
      const glm::dvec3 eye = to_object * glm::dvec4(glm::mix(cell.min, cell.max, share), 1.0);
      return glm::dot(normal, eye - glm::dvec3(a)) / glm::length(normal);
    };
    const bool answer = view.faces_away(a, b, c);
    double most = -1e300;
    for (int i = 0; i < 8; ++i) most = std::max(most, front(glm::dvec3(i & 1, i >> 1 & 1, i >> 2)));
    if (std::abs(most) > 1e-6) {
      EXPECT_EQ(answer, most < 0.0);
    }
    for (int k = 0; answer && k < 10; ++k) EXPECT_LT(front({random.in(0, 1), random.in(0, 1), random.in(0, 1)}), 1e-9);
    (answer ? away : towards) += 1;
  }
  EXPECT_GT(away, 1000);
  EXPECT_GT(towards, 1000);
}

TEST(CellFacing, OfRandomCones) {
  test::RandomShapes random(7);
  int away = 0;
  for (int n = 0; n < 20'000; ++n) {
    const glm::dvec3 center = random.point(1.0), half = glm::abs(random.point(1.0));
    const CellBox cell{center - half, center + half};
    const glm::dmat4 to_world = random.placement();
    const NormalCone cone{glm::vec3(random.unit()), static_cast<float>(random.in(0.3, 1.0))};
    const Sphere sphere{glm::vec3(random.point(4.0)), static_cast<float>(random.in(0.0, 0.5))};
    if (!CellView(cell, eyes, to_world).faces_away(cone, sphere)) continue;
    ++away;
    const glm::dmat4 to_object = glm::inverse(to_world);
    for (int k = 0; k < 20; ++k) {
      const glm::dvec3 share(random.in(0, 1), random.in(0, 1), random.in(0, 1));
      const glm::dvec3 eye = to_object * glm::dvec4(glm::mix(cell.min, cell.max, share), 1.0);
      const glm::dvec3 side = glm::normalize(glm::cross(glm::dvec3(cone.axis), random.unit()));
      const double cos_angle = static_cast<double>(cone.cos_angle);
      const glm::dvec3 normal = cos_angle * glm::dvec3(cone.axis) + std::sqrt(1.0 - cos_angle * cos_angle) * side;
      const glm::dvec3 p = glm::dvec3(sphere.center) + static_cast<double>(sphere.radius) * random.unit();
      EXPECT_LT(glm::dot(normal, eye - p), 1e-5);
    }
  }
  EXPECT_GT(away, 500);
}

// Of a rotated box grown by a margin in object units, every point is inside.
TEST(CellView, WorldBoxHoldsTheBox) {
  test::RandomShapes random(9);
  for (int n = 0; n < 2000; ++n) {
    const glm::dmat4 to_world = random.placement();
    const glm::vec3 center(random.point(3.0)), half(glm::abs(random.point(1.0)));
    const double margin = random.in(0.0, 0.5);
    const Box box{center - half, center + half};
    const CellBox around = CellView(cube, eyes, to_world).world_box(box, margin);
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
      const glm::dvec3 p = to_world * glm::dvec4(glm::dvec3(corner(box, i)) + margin * sign, 1.0);
      EXPECT_TRUE(glm::all(glm::lessThanEqual(around.min, p)) && glm::all(glm::lessThanEqual(p, around.max)));
    }
  }
}

std::string message_of(const CellBox& cell, const EyeModel& model, const glm::dmat4& to_world = glm::dmat4(1.0)) {
  try {
    const CellView view(cell, model, to_world);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(CellView, RefusesWhatIsNoCell) {
  EXPECT_EQ(message_of(cube, eyes), "");
  EXPECT_EQ(message_of(point, eyes), "");
  EXPECT_NE(message_of({{0, 0, std::nan("")}, {1, 1, 1}}, eyes).find("not a finite number"), std::string::npos);
  EXPECT_NE(message_of({{0, 2, 0}, {1, 1, 1}}, eyes).find("beyond its largest"), std::string::npos);
  EXPECT_NE(message_of(cube, eyes, glm::dmat4(0.0)).find("affine"), std::string::npos);
  EyeModel bad = eyes;
  bad.near = 0.0;
  EXPECT_NE(message_of(cube, bad).find("near"), std::string::npos);
  bad = eyes;
  bad.cos_corner_angle = 1.5;
  EXPECT_NE(message_of(cube, bad).find("cos_corner_angle"), std::string::npos);
  bad = eyes;
  bad.focal_length_px = -1.0;
  EXPECT_NE(message_of(cube, bad).find("focal_length_px"), std::string::npos);
  bad = eyes;
  bad.clearance = std::numeric_limits<double>::infinity();
  EXPECT_NE(message_of(cube, bad).find("clearance"), std::string::npos);
}

TEST(CellView, EyesOfAView) {
  Camera camera;
  const View view(camera);
  const EyeModel model = eye_model(view);
  EXPECT_EQ(model.focal_length_px, view.focal_length_px());
  EXPECT_EQ(model.cos_corner_angle, view.cos_corner_angle());
  EXPECT_EQ(model.near, camera.near);
  camera.orthographic_height = 1.0;
  EXPECT_THROW(static_cast<void>(eye_model(View(camera))), Error);
}

// 1024x768 and 60 degrees.
TEST(CellView, DefaultEyes) {
  Camera camera;
  camera.fov_y_deg = 60.0;
  const EyeModel model = eye_model(View(camera));
  EXPECT_NEAR(model.focal_length_px, EyeModel{}.focal_length_px, 0.05);
  EXPECT_NEAR(model.cos_corner_angle, EyeModel{}.cos_corner_angle, 5e-5);
}

}  // namespace
}  // namespace occlod
