#include "visibility/views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>

#include "world_box.h"

namespace occlod::bench {
namespace {

constexpr double min_covered = 0.05;  // of the picture
constexpr double max_backs = 0.001;   // of the covered pixels

// Any direction that is not along the line of sight.
glm::dvec3 up_for(const glm::dvec3& along, const glm::dvec3& wanted) {
  if (glm::length(glm::cross(glm::normalize(along), glm::normalize(wanted))) > 0.1) return wanted;
  return std::abs(wanted.x) < 0.5 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
}

}  // namespace

RandomCameras::RandomCameras(const SceneRun& run, const std::optional<tool::ImageSize>& size, std::uint64_t seed)
    : run_(run), size_(size), random_(seed) {
  const tool::WorldBox box = tool::world_box(run.objects);
  middle_ = box.center();
  radius_ = box.radius();
}

// Evenly over the sphere (Archimedes).
glm::dvec3 RandomCameras::direction() {
  const double z = random_.between(-1.0, 1.0);
  const double angle = random_.between(0.0, 2.0 * glm::pi<double>());
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

glm::dvec3 RandomCameras::surface_point() {
  const auto pick = [this](std::size_t count) {
    return static_cast<std::size_t>(random_.between(0.0, static_cast<double>(count)));
  };
  const LoadedObject& object = run_.objects[pick(run_.objects.size())];
  const auto positions = object.hierarchy->positions();
  return {object.object_to_world * glm::dvec4(positions[pick(positions.size())], 1.0)};
}

Camera RandomCameras::on_walk(const CameraPath& walk) {
  Camera camera = camera_at(walk, static_cast<int>(random_.between(0.0, walk.frames)));
  const glm::dvec3 along = direction();
  camera.up = up_for(along, camera.up);
  camera.target = camera.eye + along;
  return camera;
}

Camera RandomCameras::near_surface() {
  const glm::dvec3 on_surface = surface_point();
  glm::dvec3 away = direction();
  if (glm::dot(away, on_surface - middle_) < 0.0) away = -away;
  const double distance = 0.01 * radius_ * std::pow(250.0, random_.between(0.0, 1.0));
  Camera camera;
  camera.eye = on_surface + distance * away;
  // Not only straight down: the nearer, the more towards the horizon.
  camera.target = glm::mix(on_surface, surface_point(), random_.between(0.0, 0.5));
  camera.up = up_for(camera.target - camera.eye, run_.view.camera().up);
  camera.fov_y_deg = random_.between(30.0, 75.0);
  camera.near = 1e-3 * radius_;
  camera.far = 10.0 * radius_;
  return camera;
}

Camera RandomCameras::next() {
  const auto walk = run_.description.paths.find("walk");
  is_walking_ = walk != run_.description.paths.end() && !is_walking_;
  return sized(is_walking_ ? on_walk(walk->second) : near_surface(), size_);
}

Camera sized(Camera camera, const std::optional<tool::ImageSize>& size) {
  if (!size) return camera;
  camera.width = size->width;
  camera.height = size->height;
  return camera;
}

std::vector<NamedView> path_views(const SceneRun& run, int most, const std::optional<tool::ImageSize>& size) {
  std::vector<NamedView> views;
  for (const auto& [name, path] : run.description.paths) {
    const int shown = std::min(path.jump ? static_cast<int>(path.keys.size()) : path.frames, most);
    for (int i = 0; i < shown; ++i) {
      // Of a path that jumps the first frame of key i.
      const int keys = static_cast<int>(path.keys.size());
      const int last = path.frames - 1;
      const int frame = path.jump ? (i * path.frames + keys - 1) / keys : shown > 1 ? i * last / (shown - 1) : 0;
      views.push_back({fmt::format("{} {}", name, frame), sized(camera_at(path, frame), size)});
    }
  }
  return views;
}

bool is_fair(const SceneRun& run, const View& view, const ItemBuffer& items, std::span<const DrawObject> drawn) {
  std::vector<bool> is_back;  // by item
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const glm::dvec3 eye(glm::inverse(drawn[i].object_to_world) * glm::dvec4(view.camera().eye, 1.0));
    for (const Triangle& t : drawn[i].triangles) {
      const glm::dvec3 a(drawn[i].positions[t.x]), b(drawn[i].positions[t.y]), c(drawn[i].positions[t.z]);
      is_back.push_back(!run.objects[i].two_sided && glm::dot(glm::cross(b - a, c - a), eye - a) < 0.0);
    }
  }
  std::size_t covered = 0, backs = 0;
  for (const std::uint32_t item : items.items) {
    if (item == no_item) continue;
    ++covered;
    backs += is_back[item] ? 1U : 0U;
  }
  return static_cast<double>(covered) >= min_covered * static_cast<double>(items.items.size()) &&
         static_cast<double>(backs) <= max_backs * static_cast<double>(covered);
}

}  // namespace occlod::bench
