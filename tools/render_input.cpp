#include "render_input.h"

#include "occlod/base.h"
#include "progress.h"
#include "standard_streams.h"
#include "world_box.h"

namespace occlod::tool {
std::vector<LoadedObject> load_objects_of(const SceneDescription& scene, const std::filesystem::path& folder,
                                          bool use_cache) {
  Progress progress;
  LoadOptions options;
  options.use_cache = use_cache;
  options.progress = [&](const std::string& what, double done) { progress.show(what, done); };
  options.note = [](const std::string& line) { print_note(line); };
  return load_objects(scene, folder, options);
}

SceneDescription describe_render_input(const RenderInputOptions& options) {
  if (!is_scene_file(options.file) && !options.path.empty())
    throw Error({options.file.string(), "--path", "a single mesh has no camera path", "give a scene that has it"});
  return describe_file(options.file);
}

RenderInput load_render_input(const RenderInputOptions& options) {
  return load_render_input(options, describe_render_input(options));
}

RenderInput load_render_input(const RenderInputOptions& options, const SceneDescription& scene) {
  const bool is_scene = is_scene_file(options.file);
  RenderInput input;
  input.name = scene.name;
  if (!options.path.empty()) {
    input.path = chosen_path(scene, options);
    input.path_name = options.path;
    input.camera = camera_at(*input.path, 0);
  } else if (is_scene) {
    input.camera = chosen_camera(scene, options);
  }
  input.objects = load_objects_of(scene, options.file.parent_path(), options.use_cache);
  if (!is_scene) input.camera = camera_that_sees(world_box(input.objects), options);
  return input;
}

}  // namespace occlod::tool
