// What `occlod render` is given: a scene file, or a single mesh or hierarchy with a camera that sees all of it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "chosen_views.h"
#include "occlod/scene.h"
#include "occlod/view.h"

namespace occlod::tool {

struct RenderInputOptions : ViewOptions {
  std::filesystem::path file;
  bool use_cache = true;
};

struct RenderInput {
  std::string name;
  std::vector<LoadedObject> objects;
  Camera camera;
  std::optional<CameraPath> path;  // when one was asked for; `camera` is its first frame then
  std::string path_name;
};

// What a scene file says; for a mesh or a hierarchy, a scene of that one object. Throws Error.
[[nodiscard]] SceneDescription describe_render_input(const RenderInputOptions& options);
// Those that load_render_input() may read.
[[nodiscard]] std::vector<std::filesystem::path> mesh_files(const RenderInputOptions& options,
                                                            const SceneDescription& scene);

// Reads and builds. Shows progress and notes on standard error. Throws Error as load_objects() does.
[[nodiscard]] std::vector<LoadedObject> load_objects_of(const SceneDescription& scene,
                                                        const std::filesystem::path& folder, bool use_cache);

// The same, with where it is seen from.
[[nodiscard]] RenderInput load_render_input(const RenderInputOptions& options, const SceneDescription& scene);
[[nodiscard]] RenderInput load_render_input(const RenderInputOptions& options);

}  // namespace occlod::tool
