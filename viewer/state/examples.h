// Describes scenes that are generated, to be looked at without a file of one's own.
#pragma once

#include <span>
#include <string_view>

#include "occlod/scene.h"
#include "settings.h"

namespace occlod::viewer {

struct Example {
  const char* name = "";   // in scripts
  const char* label = "";  // in panels
  const char* about = "";  // one sentence: what there is to see
  LoadAs as = LoadAs::hierarchy;
};
[[nodiscard]] std::span<const Example> examples();
// Returns null for an unknown name.
[[nodiscard]] const Example* find_example(std::string_view name);

// Returns its scene, with a camera path to play. Nothing is generated yet.
[[nodiscard]] SceneDescription scene_of(const Example& example);

}  // namespace occlod::viewer
