// Loads what `occlod hlod render` is given: HLODs and where they are seen from.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "chosen_views.h"
#include "command_files.h"
#include "occlod/device.h"
#include "occlod/scene.h"

namespace CLI {
class App;
}

namespace occlod::tool {

struct HlodSceneOptions {
  std::filesystem::path file;   // scene, mesh or .ohlod file
  std::filesystem::path scene;  // replaces the cameras and paths of `file`, unless empty
  ViewOptions view;
  std::optional<int> frames;  // number of frames, into which a path is divided anew or for which a camera stands still
  bool use_cache = true;
  std::optional<hlod::CacheOptions> paged;  // for .ohlod files
};

struct HlodScene {
  std::string name;  // the file's, without its extension
  std::vector<LoadedHlod> hlods;
  std::vector<hlod::PlacedHlod> placed;  // point to `hlods`
  CameraPath path;                       // one key if a camera was asked for
};

// Reads and builds HLODs. For `paged` see LoadOptions. Shows progress and notes on standard error. Throws Error
// like load_hlods().
[[nodiscard]] std::vector<LoadedHlod> load_hlods_of(const SceneDescription& scene, const std::filesystem::path& folder,
                                                    bool use_cache,
                                                    const std::optional<hlod::CacheOptions>& paged = std::nullopt);

void add_hlod_scene_options(CLI::App& command, HlodSceneOptions& options);

// Holds what is known before anything but scene files is read.
struct HlodRequest {
  SceneDescription objects;
  std::optional<CameraPath> path;  // none if the camera shows all of a mesh or an HLOD
  int frames = 1;
};

// Reads scene files only. Throws Error.
[[nodiscard]] HlodRequest describe_hlod_request(const HlodSceneOptions& options);

// Adds the files that load_hlod_scene() may read.
void add_files(CommandFiles& files, const HlodSceneOptions& options);

// Reads and builds the scene. Shows progress and notes on standard error. Throws Error.
[[nodiscard]] HlodScene load_hlod_scene(const HlodSceneOptions& options, const HlodRequest& request);

}  // namespace occlod::tool
