#include "occlod/view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "occlod/base.h"

namespace occlod {
namespace {

Camera good_camera() {
  Camera camera;
  camera.eye = {0, 0, 5};
  camera.fov_y_deg = 90.0;
  camera.width = 200;
  camera.height = 100;
  camera.near = 1.0;
  camera.far = 10.0;
  return camera;
}

TEST(View, FocalLengthIsHalfTheHeightAtNinetyDegrees) {
  const View view(good_camera());
  EXPECT_NEAR(view.focal_length_px(), 50.0, 1e-12);  // (height / 2) / tan(45 deg)
  // The corner is 2 wide and 1 high at distance 1.
  EXPECT_NEAR(view.cos_corner_angle(), 1.0 / std::sqrt(6.0), 1e-12);
  EXPECT_NEAR(view.direction().z, -1.0, 1e-12);
}

TEST(View, ClipSpaceIsOpenGls) {
  const View view(good_camera());
  const glm::dvec4 on_near = view.world_to_clip() * glm::dvec4(0, 0, 4, 1);
  EXPECT_NEAR(on_near.w, 1.0, 1e-12);   // w is the distance from the eye plane
  EXPECT_NEAR(on_near.z, -1.0, 1e-12);  // z = -w on the near plane
  const glm::dvec4 on_far = view.world_to_clip() * glm::dvec4(0, 0, -5, 1);
  EXPECT_NEAR(on_far.z, on_far.w, 1e-9);
  const glm::dvec4 top = view.world_to_clip() * glm::dvec4(0, 3, 2, 1);  // 45 degrees up
  EXPECT_NEAR(top.y, top.w, 1e-12);
}

// 4 units are 100 pixels high, at any depth; w is 1, and z runs from -1 on the near plane to 1 on the far plane.
TEST(View, OrthographicShowsAsMuchAtEveryDepth) {
  Camera camera = good_camera();
  camera.orthographic_height = 4.0;
  const View view(camera);
  EXPECT_TRUE(view.is_orthographic());
  EXPECT_EQ(view.focal_length_px(), 25.0);
  EXPECT_EQ(view.cos_corner_angle(), 1.0);  // rays are along the axis
  for (const double distance : {1.0, 2.5, 10.0}) {
    const glm::dvec4 corner = view.world_to_clip() * glm::dvec4(4.0, 2.0, 5.0 - distance, 1.0);
    EXPECT_NEAR(corner.x, 1.0, 1e-12);
    EXPECT_NEAR(corner.y, 1.0, 1e-12);
    EXPECT_NEAR(corner.z, 2.0 * (distance - 1.0) / 9.0 - 1.0, 1e-12);
    EXPECT_EQ(corner.w, 1.0);
  }
}

// Nearness: 1 / distance in perspective, where a unit covers 50 px at distance 1 and 10 at 5; orthographic from 1 on
// the near plane, at 1, to 0 on the far plane, at 10.
TEST(View, DistanceAndScaleFollowFromNearness) {
  Camera camera = good_camera();
  EXPECT_DOUBLE_EQ(View(camera).distance_at(0.2), 5.0);
  EXPECT_NEAR(View(camera).scale_px_at(0.2), 10.0, 1e-12);
  camera.orthographic_height = 4.0;
  EXPECT_DOUBLE_EQ(View(camera).distance_at(1.0), 1.0);
  EXPECT_DOUBLE_EQ(View(camera).distance_at(0.0), 10.0);
  EXPECT_DOUBLE_EQ(View(camera).distance_at(0.5), 5.5);
  EXPECT_EQ(View(camera).scale_px_at(0.5), 25.0);
}

// At 90 degrees a camera 5 units from its target shows 10 units there.
TEST(View, OrthographicKeepsWhatIsShownAtTheTarget) {
  const Camera camera = orthographic(good_camera());
  ASSERT_TRUE(camera.orthographic_height);
  EXPECT_NEAR(*camera.orthographic_height, 10.0, 1e-12);
  const glm::dvec4 perspective = View(good_camera()).world_to_clip() * glm::dvec4(3.0, -2.0, 0.0, 1.0);
  const glm::dvec4 parallel = View(camera).world_to_clip() * glm::dvec4(3.0, -2.0, 0.0, 1.0);
  EXPECT_NEAR(perspective.x / perspective.w, parallel.x, 1e-12);
  EXPECT_NEAR(perspective.y / perspective.w, parallel.y, 1e-12);
}

// Twice as wide as high, 90 degrees high: a sphere of radius 3 touches the upper and lower planes at 3 sqrt 2, of which
// a fiftieth is added. A picture half as wide as high shows as much to the sides as one of atan(1/2) = 26.57 degrees to
// each side.
TEST(Camera, FitsASphereIntoTheSmallerSide) {
  Camera camera = good_camera();
  EXPECT_NEAR(fitting_distance(camera, 3.0), 1.02 * 3.0 * std::sqrt(2.0), 1e-12);
  camera.width = camera.height / 2;
  EXPECT_NEAR(fitting_distance(camera, 3.0), 1.02 * 3.0 * std::sqrt(5.0), 1e-12);
}

TEST(Camera, LooksAtAllOfABox) {
  const Box box{{100.0F, -3.0F, 7.0F}, {104.0F, 2.0F, 8.0F}};
  for (const glm::ivec2 size : {glm::ivec2(640, 480), glm::ivec2(200, 900)}) {
    const Camera camera = looking_at(box, {.width = size.x, .height = size.y});
    EXPECT_EQ(camera.width, size.x);
    const View view(camera);
    double most = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec4 at(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                          corner & 4 ? box.max.z : box.min.z, 1.0);
      const glm::dvec4 clip = view.world_to_clip() * at;
      for (int k = 0; k < 3; ++k) EXPECT_LT(std::abs(clip[k]), clip.w);
      most = std::max({most, std::abs(clip.x) / clip.w, std::abs(clip.y) / clip.w});
    }
    EXPECT_GT(most, 0.5) << "the box is a speck";
  }
  EXPECT_NO_THROW(View(looking_at(Box{}))) << "a point";
}

TEST(View, RefusesCamerasThatMakeNoImage) {
  const auto refused = [](auto change) {
    Camera camera = good_camera();
    change(camera);
    EXPECT_THROW(View{camera}, Error);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([&](Camera& c) { c.eye.x = nan; });
  refused([&](Camera& c) { c.target.y = nan; });
  refused([&](Camera& c) { c.up = {0, nan, 0}; });
  refused([](Camera& c) { c.target = c.eye; });
  refused([](Camera& c) { c.up = {0, 0, 2}; });  // along the line of sight
  refused([](Camera& c) { c.up = {0, 0, 0}; });
  refused([](Camera& c) { c.fov_y_deg = 0.0; });
  refused([](Camera& c) { c.fov_y_deg = 180.0; });
  refused([](Camera& c) { c.width = 0; });
  refused([](Camera& c) { c.height = 20000; });
  refused([](Camera& c) { c.near = 0.0; });
  refused([](Camera& c) { c.far = c.near; });
  for (const double height : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()})
    refused([&](Camera& c) { c.orthographic_height = height; });
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double value : {nan, infinite}) {
    refused([&](Camera& c) { c.eye.z = value; });
    refused([&](Camera& c) { c.target.x = value; });
    refused([&](Camera& c) { c.up.z = value; });
    refused([&](Camera& c) { c.fov_y_deg = value; });
    refused([&](Camera& c) { c.near = value; });
    refused([&](Camera& c) { c.far = value; });
  }
  EXPECT_NO_THROW(View{good_camera()});
}

// Finite numbers whose products are not: 2 near far, and one over the tangent of half the angle.
TEST(View, RefusesCamerasWhoseMatrixOverflows) {
  Camera camera = good_camera();
  camera.far = 1.7e308;
  EXPECT_THROW(View{camera}, Error);
  camera = good_camera();
  camera.fov_y_deg = 1e-310;
  EXPECT_THROW(View{camera}, Error);
  camera = good_camera();
  camera.orthographic_height = 1e-310;
  EXPECT_THROW(View{camera}, Error);
}

}  // namespace
}  // namespace occlod
