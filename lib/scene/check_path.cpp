#include "scene/check_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "occlod/scene.h"
#include "occlod/view.h"

namespace occlod {
namespace {

std::optional<BadFrame> check_frame(const CameraPath& path, int frame) {
  try {
    const View view(camera_at(path, frame));
  } catch (const Error& error) {
    return BadFrame{frame, path.frames, error.diagnosis()};
  }
  return std::nullopt;
}

// Returns whether all cameras between two of one segment have a view. Their lines of sight and up directions are
// combinations, with non-negative weights, of those at the ends, so the cross products of the two are combinations of
// the four at the ends. When these lie in one half-space, none of the former is 0.
bool is_clear_between(const Camera& a, const Camera& b) {
  constexpr double margin = 1e-8;  // sine of the angle between line of sight and up; View requires 1e-9
  const glm::dvec3 sights[] = {glm::normalize(a.target - a.eye), glm::normalize(b.target - b.eye)};
  const glm::dvec3 ups[] = {glm::normalize(a.up), glm::normalize(b.up)};
  glm::dvec3 sum(0.0);
  for (const glm::dvec3& sight : sights)
    for (const glm::dvec3& up : ups) sum += glm::cross(sight, up);
  if (!(glm::length(sum) > margin)) return false;
  const glm::dvec3 axis = glm::normalize(sum);
  for (const glm::dvec3& sight : sights)
    for (const glm::dvec3& up : ups)
      if (!(glm::dot(axis, glm::cross(sight, up)) > margin)) return false;
  return true;
}

// Returns the first bad frame from `first` to `last`, both of one segment and `first` good.
std::optional<BadFrame> check_segment(const CameraPath& path, int first, int last) {
  if (first == last) return std::nullopt;
  if (last - first == 1) return check_frame(path, last);
  if (!check_frame(path, last) && is_clear_between(camera_at(path, first), camera_at(path, last))) return std::nullopt;
  const int middle = first + (last - first) / 2;
  if (auto bad = check_segment(path, first, middle)) return bad;
  return check_segment(path, middle, last);
}

// Holds the first and the last frame between two neighbouring keys or on them; `first` is the later one where there is
// none.
struct Segment {
  int first, last;
};

Segment segment_after(const CameraPath& path, std::size_t key) {
  const auto steps = static_cast<std::uint64_t>(path.frames) - 1;
  const std::uint64_t segments = path.keys.size() - 1;
  return {static_cast<int>((steps * key + segments - 1) / segments), static_cast<int>(steps * (key + 1) / segments)};
}

}  // namespace

std::string BadFrame::text() const {
  return fmt::format("makes no view in frame {} of {}, numbered from 0: {} {}", frame, frames, problem.place,
                     problem.problem);
}

std::optional<BadFrame> find_bad_frame(const CameraPath& path) {
  if (path.jump || path.keys.size() < 2) return std::nullopt;  // every frame is a key
  for (std::size_t key = 0; key + 1 < path.keys.size(); ++key) {
    const auto [first, last] = segment_after(path, key);
    if (first > last) continue;
    if (auto bad = check_frame(path, first)) return bad;
    if (auto bad = check_segment(path, first, last)) return bad;
  }
  return std::nullopt;
}

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
  if (camera.orthographic_height)  // set in all keys or none
    camera.orthographic_height = glm::mix(*a.orthographic_height, *b.orthographic_height, t);
  camera.principal_point = glm::mix(a.principal_point, b.principal_point, t);
  camera.near = glm::mix(a.near, b.near, t);
  camera.far = glm::mix(a.far, b.far, t);
  return camera;
}

}  // namespace occlod
