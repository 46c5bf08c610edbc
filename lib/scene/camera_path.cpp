#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "occlod/scene/scene.h"

namespace occlod {
namespace {

Camera held_key(const CameraPath& path, int frame) {
  Camera camera = path.keys[static_cast<std::size_t>(frame) * path.keys.size() / static_cast<std::size_t>(path.frames)];
  camera.width = path.keys.front().width;
  camera.height = path.keys.front().height;
  return camera;
}

}  // namespace

Camera camera_at(const CameraPath& path, int frame) {
  assert(!path.keys.empty() && frame >= 0 && frame < path.frames);
  if (path.jump) return held_key(path, frame);
  const auto last = path.keys.size() - 1;
  const double place = path.frames > 1 ? static_cast<double>(last) * frame / (path.frames - 1) : 0.0;
  const std::size_t i = std::min(static_cast<std::size_t>(place), last);
  const Camera& a = path.keys[i];
  const Camera& b = path.keys[std::min(i + 1, last)];
  const double t = place - static_cast<double>(i);

  Camera camera = path.keys.front();
  camera.eye = glm::mix(a.eye, b.eye, t);
  camera.target = glm::mix(a.target, b.target, t);
  camera.up = glm::normalize(glm::mix(glm::normalize(a.up), glm::normalize(b.up), t));
  camera.fov_y_deg = glm::mix(a.fov_y_deg, b.fov_y_deg, t);
  if (camera.orthographic_height)  // of all keys or none
    camera.orthographic_height = glm::mix(*a.orthographic_height, *b.orthographic_height, t);
  camera.near = glm::mix(a.near, b.near, t);
  camera.far = glm::mix(a.far, b.far, t);
  return camera;
}

}  // namespace occlod
