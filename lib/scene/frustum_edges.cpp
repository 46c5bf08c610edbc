#include "scene/frustum_edges.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace occlod::picture {

std::vector<std::array<glm::dvec3, 2>> frustum_edges(const View& view, double length) {
  const Camera& camera = view.camera();
  const glm::dvec3 right = glm::normalize(glm::cross(view.direction(), camera.up));
  const glm::dvec3 up = glm::cross(right, view.direction());
  const glm::dvec2 half = glm::dvec2(camera.width, camera.height) / (2.0 * view.focal_length_px());
  const std::array<glm::dvec3, 4> to_corners = {-half.x * right - half.y * up, half.x * right - half.y * up,
                                                half.x * right + half.y * up, -half.x * right + half.y * up};
  const bool parallel = view.is_orthographic();
  const auto corner = [&](std::size_t i, double distance) {
    return camera.eye + distance * view.direction() + (parallel ? 1.0 : distance) * to_corners[i % 4];
  };
  std::vector<std::array<glm::dvec3, 2>> edges;
  for (std::size_t i = 0; i < 4; ++i) {
    edges.push_back({corner(i, 0.0), corner(i, length)});
    edges.push_back({corner(i, length), corner(i + 1, length)});
    if (parallel) edges.push_back({corner(i, 0.0), corner(i + 1, 0.0)});
  }
  return edges;
}

}  // namespace occlod::picture
