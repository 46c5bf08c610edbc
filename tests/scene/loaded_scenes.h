// For tests of what is loaded from scenes and cached: hierarchies and HLODs.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "occlod/scene.h"
#include "scene/scene_folder.h"

namespace occlod::test {

[[nodiscard]] inline SceneDescription scene_of(std::vector<SceneObject> objects) {
  SceneDescription scene;
  scene.name = "test";
  scene.objects = std::move(objects);
  return scene;
}

class LoadedScenes : public SceneFolder {
 protected:
  // They write down what is told meanwhile.
  [[nodiscard]] LoadOptions noting_options() {
    LoadOptions options;
    options.note = [this](const std::string& line) { notes_.push_back(line); };
    options.progress = [this](const std::string&, double) { ++progress_; };
    options.use_cache = use_cache_;
    return options;
  }

  [[nodiscard]] std::vector<std::filesystem::path> cached() const {
    const std::filesystem::path cache = folder() / "cache" / "occlod";
    if (!std::filesystem::exists(cache)) return {};
    return {std::filesystem::directory_iterator(cache), {}};
  }

  std::vector<std::string> notes_;
  int progress_ = 0;  // how often it was told
  bool use_cache_ = true;
};

}  // namespace occlod::test
