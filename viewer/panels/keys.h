// Lists what keys do, for the window and for its help.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "session.h"

namespace occlod::viewer {

struct KeyBinding {
  int key = 0;   // GLFW_KEY_...
  int mods = 0;  // GLFW_MOD_SHIFT, GLFW_MOD_CONTROL
  const char* keys = "";
  const char* what = "";
  nlohmann::json action;
  // What it does instead while HLODs are open, or view cells are walked through; null: the same; a string: why nothing.
  nlohmann::json with_hlods = nullptr;
  nlohmann::json with_cells = nullptr;
};
[[nodiscard]] const std::vector<KeyBinding>& key_bindings();

// Names what keys and controls act on. With the split screen, cells are drawn beside a refinement.
enum class Shown { meshes, hlods, cells, cells_beside_meshes };
[[nodiscard]] Shown shown_in(const Session& session);
// Returns what a key does with what is shown: an action, or a string that says why nothing.
[[nodiscard]] const nlohmann::json& action_of(const KeyBinding& binding, Shown shown);

}  // namespace occlod::viewer
