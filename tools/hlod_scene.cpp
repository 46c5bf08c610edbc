#include "hlod_scene.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <utility>

#include "drawing.h"
#include "occlod/base.h"
#include "occlod/view.h"
#include "option_values.h"
#include "progress.h"
#include "render_input.h"
#include "standard_streams.h"
#include "world_box.h"

namespace occlod::tool {
namespace {

constexpr std::uint64_t max_frames = 1'000'000;

// Returns the scene that has the cameras.
SceneDescription read_views(const HlodSceneOptions& options, const SceneDescription& objects) {
  return options.scene.empty() ? objects : read_scene(options.scene);
}

bool has_views(const HlodSceneOptions& options) { return is_scene_file(options.file) || !options.scene.empty(); }

void check(const HlodSceneOptions& options) {
  if (!options.scene.empty() && !is_scene_file(options.scene))
    throw Error({options.scene.string(), "--scene", "is not a scene file", "name a .json file with cameras"});
  if (!options.scene.empty() && is_scene_file(options.file))
    throw Error({options.file.string(), "--scene", "this scene has cameras of its own", "leave --scene out"});
  if (!has_views(options) && !options.view.path.empty())
    throw Error({options.file.string(), "--path", "it has no camera path", "name a scene that has it by --scene"});
}

// Returns the file's path, with as many frames as were asked for.
CameraPath path_of(const HlodSceneOptions& options, const SceneDescription& views) {
  CameraPath path = chosen_path(views, options.view);
  path.frames = options.frames.value_or(path.frames);
  if (path.jump && path.keys.size() > static_cast<std::size_t>(path.frames))
    throw Error({views.file.string(), "--frames", fmt::format("this path jumps to {} places", path.keys.size()),
                 "ask for as many frames at least"});
  for (int i = 0; i < path.frames; ++i) (void)View(camera_at(path, i));  // checks all views before anything is drawn
  return path;
}

// Returns a path on which the camera stands still.
CameraPath still(const Camera& camera, const HlodSceneOptions& options) {
  return {{camera}, options.frames.value_or(1), false};
}

}  // namespace

std::vector<LoadedHlod> load_hlods_of(const SceneDescription& scene, const std::filesystem::path& folder,
                                      bool use_cache, const std::optional<hlod::CacheOptions>& paged) {
  Progress progress;
  LoadOptions options;
  options.use_cache = use_cache;
  options.paged = paged;
  options.progress = [&](const std::string& what, double done) { progress.show(what, done); };
  options.note = [](const std::string& line) { print_note(line); };
  return load_hlods(scene, folder, options);
}

void add_hlod_scene_options(CLI::App& command, HlodSceneOptions& options) {
  add_file(command, "INPUT", options.file, "An HLOD (.ohlod), a scene (.json) or a mesh")->required();
  add_file(command, "--scene", options.scene,
           "Take cameras and paths of this scene (.json), for an HLOD that was built from it");
  CLI::Option* camera =
      add_name(command, "--camera", options.view.camera, "Camera of the scene")->capture_default_str();
  add_name(command, "--path", options.view.path, "Draw every frame of this camera path of the scene")->excludes(camera);
  add_number(command, "--frames", options.frames, WholeRange{1, max_frames},
             "With --path: go along it in so many frames instead of its own number; else stand still for so many")
      ->option_text("N");
  add_size_options(command, options.view);
}

HlodRequest describe_hlod_request(const HlodSceneOptions& options) {
  check(options);
  HlodRequest request;
  request.objects = describe_file(options.file);
  const SceneDescription views = read_views(options, request.objects);
  if (!options.view.path.empty())
    request.path = path_of(options, views);
  else if (has_views(options))
    request.path = still(chosen_camera(views, options.view), options);
  request.frames = request.path ? request.path->frames : options.frames.value_or(1);
  return request;
}

void add_files(CommandFiles& files, const HlodSceneOptions& options) {
  files.add_input("the input", options.file);
  if (!options.scene.empty()) files.add_input("the scene with the cameras", options.scene);
}

HlodScene load_hlod_scene(const HlodSceneOptions& options, const HlodRequest& request) {
  HlodScene scene;
  scene.name = request.objects.name;
  scene.hlods = load_hlods_of(request.objects, options.file.parent_path(), options.use_cache, options.paged);
  scene.path = request.path ? *request.path : still(camera_that_sees(world_box(scene.hlods), options.view), options);
  scene.placed = placed_objects(scene.hlods);
  return scene;
}

}  // namespace occlod::tool
