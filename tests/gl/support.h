// A view of 64 x 48 pixels along -z, and a wall in the plane z = 0.
#pragma once

#include <gtest/gtest.h>

#include <glm/ext/matrix_transform.hpp>
#include <memory>
#include <string>
#include <vector>

#include "gl/functions.h"
#include "gl/proxies.h"
#include "occlod/gl.h"
#include "occlod/view.h"
#include "occlod/visibility.h"

namespace occlod::gl {

// Null, with the reason in `why`, where the machine has no such platform.
[[nodiscard]] std::shared_ptr<Context> context_or_null(Platform platform, std::string& why);

[[nodiscard]] std::string platform_label(Platform platform);
[[nodiscard]] std::string shape_label(ProxyShape shape);

// Eye at (0, 0, 3), 45 degrees up and down: a pixel at z = 0 is 3 * 2 tan(22.5 deg) / 48 wide.
inline constexpr double pixel_at_wall = 0.05177669529663688;
[[nodiscard]] View test_view();

// What the tests draw: positions and triangles that live as long as needed.
struct Soup {
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;
  void add_quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d);
  [[nodiscard]] OccluderPart part(std::uint32_t object = 0) const { return {object, positions, triangles}; }
};
// [-1, 1]^2 in the plane z = 0.
[[nodiscard]] Soup wall();
// The same with a hole over [x0, x1] x [y0, y1].
[[nodiscard]] Soup wall_with_hole(float x0, float x1, float y0, float y1);

}  // namespace occlod::gl
