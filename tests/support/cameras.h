#pragma once

#include "occlod/view.h"

namespace occlod::test {

// From the origin along -z, 90 degrees high: the focal length is half the height.
[[nodiscard]] inline Camera origin_camera(int width, int height) {
  Camera camera;
  camera.eye = {0, 0, 0};
  camera.target = {0, 0, -1};
  camera.fov_y_deg = 90.0;
  camera.width = width;
  camera.height = height;
  return camera;
}

}  // namespace occlod::test
