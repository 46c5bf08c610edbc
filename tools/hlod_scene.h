// What `occlod hlod render` is given: HLODs and where they are seen from.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chosen_views.h"
#include "occlod/device.h"
#include "occlod/scene.h"

namespace CLI {
class App;
}

namespace occlod::tool {

struct HlodSceneOptions {
  std::filesystem::path file;   // scene, mesh or .ohlod file
  std::filesystem::path scene;  // whose cameras and paths are taken instead; empty: those of the file
  ViewOptions view;
  std::optional<int> frames;  // into so many a path is divided anew, or for which a camera stands still
  bool use_cache = true;
  std::optional<hlod::CacheOptions> paged;  // of .ohlod files
};

struct HlodScene {
  std::string name;  // of the file, without its extension
  std::vector<LoadedHlod> hlods;
  std::vector<hlod::PlacedHlod> placed;  // point to `hlods`
  CameraPath path;                       // of one key where a camera was asked for
};

// Reads and builds. `paged`: as in LoadOptions. Shows progress and notes on standard error. Throws Error as
// load_hlods() does.
[[nodiscard]] std::vector<LoadedHlod> load_hlods_of(const SceneDescription& scene, const std::filesystem::path& folder,
                                                    bool use_cache,
                                                    const std::optional<hlod::CacheOptions>& paged = std::nullopt);

void add_hlod_scene_options(CLI::App& command, HlodSceneOptions& options);

// What is known before anything is read but scene files.
struct HlodRequest {
  SceneDescription objects;
  std::optional<CameraPath> path;  // none where the camera shows all of a mesh or an HLOD
  int frames = 1;
};

// Throws Error.
[[nodiscard]] HlodRequest describe_hlod_request(const HlodSceneOptions& options);

// Files that load_hlod_scene() may read, with what they are, for messages.
[[nodiscard]] std::vector<std::pair<std::string, std::filesystem::path>> files_of(const HlodSceneOptions& options,
                                                                                  const HlodRequest& request);

// Reads and builds. Shows progress and notes on standard error. Throws Error.
[[nodiscard]] HlodScene load_hlod_scene(const HlodSceneOptions& options, const HlodRequest& request);

}  // namespace occlod::tool
