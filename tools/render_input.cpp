#include "render_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <utility>
#include <variant>

#include "occlod/core/error.h"
#include "progress.h"
#include "standard_streams.h"
#include "world_box.h"

namespace occlod::tool {
namespace {

std::vector<LoadedObject> load(const SceneDescription& scene, const RenderInputOptions& options) {
  Progress progress;
  LoadOptions load_options;
  load_options.use_cache = options.use_cache;
  load_options.progress = [&](const std::string& what, double done) { progress.show(what, done); };
  load_options.note = [](const std::string& line) { print_note(line); };
  return load_objects(scene, options.file.parent_path(), load_options);
}

// What has this name among the cameras or paths of a scene.
template <typename Named>
const Named& find_named(const std::map<std::string, Named>& all, const std::string& name, const char* place,
                        const RenderInputOptions& options) {
  const auto found = all.find(name);
  if (found != all.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [other, ignored] : all) names.push_back(other);
  throw Error({options.file.string(), place, fmt::format("has no \"{}\"", name),
               names.empty() ? "add it" : fmt::format("use one of: {}", fmt::join(names, ", "))});
}

void resize(Camera& camera, const std::optional<ImageSize>& size) {
  if (!size) return;
  camera.width = size->width;
  camera.height = size->height;
}

void flatten(Camera& camera) {
  if (!camera.orthographic_height) camera = orthographic(camera);
}

// Looks at the sphere around all objects, from a little above and to the right, as near as shows all of it.
Camera camera_that_sees(const std::vector<LoadedObject>& objects, const ImageSize& size) {
  const WorldBox box = world_box(objects);
  const double radius = std::max(box.radius(), std::numeric_limits<float>::min() * 1.0);
  Camera camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.target = box.center();
  const double distance = fitting_distance(camera, radius);
  camera.eye = camera.target + distance * glm::normalize(glm::dvec3(1.0, 1.0, 2.0));
  camera.near = (distance - radius) / 2.0;
  camera.far = distance + 2.0 * radius;
  return camera;
}

}  // namespace

SceneDescription describe_render_input(const RenderInputOptions& options) {
  if (!is_scene_file(options.file) && !options.path.empty())
    throw Error({options.file.string(), "--path", "a single mesh has no camera path", "give a scene that has it"});
  return describe_file(options.file);
}

std::vector<std::filesystem::path> mesh_files(const RenderInputOptions& options, const SceneDescription& scene) {
  std::vector<std::filesystem::path> files;
  for (const SceneObject& object : scene.objects)
    if (const auto* source = std::get_if<MeshFile>(&object.source))
      for (const std::string& name : source->names)
        if (auto file = find_mesh(name, options.file.parent_path()); !file.empty()) files.push_back(std::move(file));
  return files;
}

RenderInput load_render_input(const RenderInputOptions& options) {
  return load_render_input(options, describe_render_input(options));
}

RenderInput load_render_input(const RenderInputOptions& options, const SceneDescription& scene) {
  RenderInput input;
  input.name = scene.name;
  if (!options.path.empty()) {
    input.path = find_named(scene.paths, options.path, "/paths", options);
    input.path_name = options.path;
    resize(input.path->keys.front(), options.size);  // the size of all frames
    if (options.orthographic) std::for_each(input.path->keys.begin(), input.path->keys.end(), flatten);
    input.camera = camera_at(*input.path, 0);
  } else if (is_scene_file(options.file)) {
    input.camera = find_named(scene.cameras, options.camera, "/cameras", options);
  }
  resize(input.camera, options.size);
  input.objects = load(scene, options);
  if (!is_scene_file(options.file))
    input.camera = camera_that_sees(input.objects, {input.camera.width, input.camera.height});
  if (options.orthographic) flatten(input.camera);
  return input;
}

}  // namespace occlod::tool
