// Squares facing the viewer, and one pixel of an image.
#pragma once

#include <vector>

#include "occlod/picture.h"
#include "support/cameras.h"

namespace occlod::test {

// The eye at the origin looks along -z; f = 40 px, image 100 x 80.
inline View front_view() { return View(origin_camera(100, 80)); }

// The same with parallel rays: 8 units are 80 px high, nearness runs from 1 at distance 1 to 0 at 101.
inline View parallel_view() {
  Camera camera = front_view().camera();
  camera.orthographic_height = 8.0;
  camera.near = 1.0;
  camera.far = 101.0;
  return View(camera);
}

// x0 <= x <= x1, y0 <= y <= y1 in the plane z, counter-clockwise seen from +z; its diagonal runs from (x0, y0) to (x1,
// y1).
struct Quad {
  Quad(float x0, float y0, float x1, float y1, float z)
      : positions{{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}} {}

  [[nodiscard]] DrawObject object() const { return {positions, colors, triangles, glm::dmat4(1.0)}; }

  std::vector<glm::vec3> positions;
  std::vector<glm::u8vec4> colors;
  std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}};
};

inline glm::u8vec4 pixel(const Image& image, int x, int y) {
  return image
      .pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)];
}

inline int brightness(const glm::u8vec4& p) { return p.x + p.y + p.z; }

}  // namespace occlod::test
