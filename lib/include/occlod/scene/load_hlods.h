// Scenes as HLODs: built from all objects together, or read from .ohlod files.
#pragma once

#include <filesystem>
#include <functional>
#include <glm/mat4x4.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "occlod/hlod/build.h"
#include "occlod/hlod/hlod.h"
#include "occlod/hlod/node_store.h"
#include "occlod/scene/scene.h"

namespace occlod {

// How HLODs are loaded.
struct HlodLoadOptions {
  hlod::BuildOptions build = {};  // of an HLOD that has to be built
  bool use_cache = true;          // as LoadOptions::use_cache
  // .ohlod files are opened by open_ohlod(): their meshes come and go. The budget is that of all files together, each
  // has an equal share. Objects that are no .ohlod files are an error then.
  std::optional<hlod::CacheOptions> paged = {};
  // As LoadOptions::progress.
  std::function<void(const std::string& what, double done)> progress = {};
  // As LoadOptions::note.
  std::function<void(const std::string& line)> note = {};
};

// One HLOD, ready to be drawn.
struct LoadedHlod {
  std::shared_ptr<const hlod::Hlod> hlod;  // shared by objects with the same file; all its meshes have been checked or
                                           // are in a store
  glm::dmat4 object_to_world{1.0};         // as in the scene; none where objects were flattened
  bool two_sided = false;                  // as in the scene; where objects were flattened, of any of them
  std::string source_name;                 // the file or, where objects were flattened, the scene
};

// All objects that are no .ohlod files as one HLOD of flatten_scene(), fetched from the cache or built, then each
// .ohlod file where the scene has it. `folder` as in load_objects(). Throws Error as flatten_scene(), read_ohlod()
// and open_ohlod() do, and for a mesh without triangles.
[[nodiscard]] std::vector<LoadedHlod> load_hlods(const SceneDescription& scene, const std::filesystem::path& folder,
                                                 const HlodLoadOptions& options = {});

}  // namespace occlod
