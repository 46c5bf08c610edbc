#include "occlod/view/view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "occlod/core/error.h"

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
  EXPECT_NO_THROW(View{good_camera()});
}

}  // namespace
}  // namespace occlod
