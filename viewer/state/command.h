// What can be done, by name: the table behind panels, keys and scripts.
#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "base/strict_json.h"

namespace occlod::viewer {

class Session;

struct Parameter {
  const char* name = "";
  const char* what = "";
  bool required = true;
};

struct Command {
  const char* name = "";   // in scripts
  const char* label = "";  // in panels
  const char* help = "";   // one sentence
  std::vector<Parameter> parameters{};
  std::function<void(Session&, const JsonPlace&)> run{};  // the parameters have been checked to be there
  bool settled = true;  // scripts wait before it until nothing is loaded and the mesh is what was asked for
};

[[nodiscard]] std::span<const Command> scene_commands();
[[nodiscard]] std::span<const Command> camera_commands();
[[nodiscard]] std::span<const Command> path_commands();
[[nodiscard]] std::span<const Command> output_commands();
[[nodiscard]] std::vector<const Command*> all_commands();

// Null when there is none of that name.
[[nodiscard]] const Command* find_command(std::string_view name);

}  // namespace occlod::viewer
