#include <gtest/gtest.h>

#include "occlod/scene.h"

namespace occlod {
namespace {

Camera camera_from(double x, double fov_y_deg) {
  Camera camera;
  camera.eye = {x, 0.0, 5.0};
  camera.target = {x, 1.0, 0.0};
  camera.fov_y_deg = fov_y_deg;
  return camera;
}

// Three keys over five frames: keys stand at frames 0, 2 and 4, frames 1 and 3 lie half way between two of them.
TEST(CameraPath, PassesThroughItsKeysAndHalfWayBetween) {
  const CameraPath path{{camera_from(0, 30), camera_from(4, 40), camera_from(10, 90)}, 5};
  const double eyes[] = {0, 2, 4, 7, 10};
  const double angles[] = {30, 35, 40, 65, 90};
  for (int frame = 0; frame < 5; ++frame) {
    const Camera camera = camera_at(path, frame);
    EXPECT_DOUBLE_EQ(camera.eye.x, eyes[frame]) << frame;
    EXPECT_DOUBLE_EQ(camera.target.x, eyes[frame]) << frame;
    EXPECT_DOUBLE_EQ(camera.fov_y_deg, angles[frame]) << frame;
  }
}

TEST(CameraPath, OneFrameIsTheFirstKey) {
  const CameraPath path{{camera_from(3, 30), camera_from(4, 40)}, 1};
  EXPECT_EQ(camera_at(path, 0).eye.x, 3.0);
}

TEST(CameraPath, OneKeyStandsStill) {
  const CameraPath path{{camera_from(3, 30)}, 7};
  EXPECT_EQ(camera_at(path, 6).eye.x, 3.0);
}

// Three keys over seven frames: key floor(3 i / 7), exactly as it is given, and nothing between.
TEST(CameraPath, JumpHoldsEachKey) {
  const CameraPath path{{camera_from(0, 30), camera_from(4, 40), camera_from(10, 90)}, 7, true};
  const double eyes[] = {0, 0, 0, 4, 4, 10, 10};
  const double angles[] = {30, 30, 30, 40, 40, 90, 90};
  for (int frame = 0; frame < 7; ++frame) {
    EXPECT_EQ(camera_at(path, frame).eye.x, eyes[frame]) << frame;
    EXPECT_EQ(camera_at(path, frame).fov_y_deg, angles[frame]) << frame;
  }
}

TEST(CameraPath, OrthographicHeightsLieBetweenTheirKeys) {
  CameraPath path{{camera_from(0, 30), camera_from(4, 30)}, 5};
  path.keys[0].orthographic_height = 2.0;
  path.keys[1].orthographic_height = 4.0;
  EXPECT_DOUBLE_EQ(camera_at(path, 1).orthographic_height.value_or(0.0), 2.5);
  EXPECT_DOUBLE_EQ(camera_at(path, 4).orthographic_height.value_or(0.0), 4.0);
}

TEST(CameraPath, PrincipalPointsLieBetweenTheirKeys) {
  CameraPath path{{camera_from(0, 30), camera_from(4, 30)}, 5};
  path.keys[1].principal_point = {1.0, -2.0};
  EXPECT_EQ(camera_at(path, 0).principal_point, glm::dvec2(0.0));
  EXPECT_EQ(camera_at(path, 1).principal_point, glm::dvec2(0.25, -0.5));
}

// Frames of one path are one film: a key's own size does not change it.
TEST(CameraPath, JumpKeepsTheSizeOfTheFirstKey) {
  CameraPath path{{camera_from(0, 30), camera_from(4, 40)}, 2, true};
  path.keys[1].width = 17;
  EXPECT_EQ(camera_at(path, 1).width, path.keys[0].width);
}

}  // namespace
}  // namespace occlod
