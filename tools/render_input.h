// Loads what `occlod render` is given: a scene file, or a single mesh or hierarchy with a camera that sees all of it.
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
  std::optional<CameraPath> path;  // if one was asked for; then `camera` is its first frame
  std::string path_name;
};

// Returns the content of a scene file, or a scene of the one mesh or hierarchy. Throws Error.
[[nodiscard]] SceneDescription describe_render_input(const RenderInputOptions& options);

// Reads and builds objects. Shows progress and notes on standard error. Throws Error like load_objects().
[[nodiscard]] std::vector<LoadedObject> load_objects_of(const SceneDescription& scene,
                                                        const std::filesystem::path& folder, bool use_cache);

// Reads and builds objects, and chooses from where they are seen.
[[nodiscard]] RenderInput load_render_input(const RenderInputOptions& options, const SceneDescription& scene);
[[nodiscard]] RenderInput load_render_input(const RenderInputOptions& options);

}  // namespace occlod::tool
