#include "gl/support.h"

#include "occlod/base.h"

namespace occlod::gl {

std::shared_ptr<Context> context_or_null(Platform platform, std::string& why) {
  try {
    return create_context(platform);
  } catch (const Error& error) {
    why = error.what();
    return nullptr;
  }
}

std::string platform_label(Platform platform) { return platform == Platform::egl ? "egl" : "osmesa"; }

std::string shape_label(ProxyShape shape) {
  return shape == ProxyShape::sphere ? "sphere" : shape == ProxyShape::box ? "box" : "cylinder";
}

View test_view() {
  Camera camera;
  camera.width = 64;
  camera.height = 48;
  camera.near = 0.1;
  camera.far = 10.0;
  return View(camera);
}

void Soup::add_quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
  const auto first = static_cast<std::uint32_t>(positions.size());
  positions.insert(positions.end(), {a, b, c, d});
  triangles.emplace_back(first, first + 1, first + 2);
  triangles.emplace_back(first, first + 2, first + 3);
}

Soup wall() {
  Soup soup;
  soup.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  return soup;
}

Soup wall_with_hole(float x0, float x1, float y0, float y1) {
  Soup soup;
  soup.add_quad({-1, -1, 0}, {x0, -1, 0}, {x0, 1, 0}, {-1, 1, 0});
  soup.add_quad({x1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {x1, 1, 0});
  soup.add_quad({x0, -1, 0}, {x1, -1, 0}, {x1, y0, 0}, {x0, y0, 0});
  soup.add_quad({x0, y1, 0}, {x1, y1, 0}, {x1, 1, 0}, {x0, 1, 0});
  return soup;
}

}  // namespace occlod::gl
