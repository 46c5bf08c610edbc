// Lists what keys do, for the window and for its help.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

namespace occlod::viewer {

struct KeyBinding {
  int key = 0;   // GLFW_KEY_...
  int mods = 0;  // GLFW_MOD_SHIFT, GLFW_MOD_CONTROL
  const char* keys = "";
  const char* what = "";
  nlohmann::json action;
};
[[nodiscard]] const std::vector<KeyBinding>& key_bindings();

}  // namespace occlod::viewer
