// Lists what can be done by name, for panels, keys and scripts.
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
  std::function<void(Session&, const JsonPlace&)> run{};  // required parameters have been checked to exist
  bool settled = true;  // scripts wait before it until everything is loaded and refined as requested
};

[[nodiscard]] std::span<const Command> scene_commands();
[[nodiscard]] std::span<const Command> camera_commands();
[[nodiscard]] std::span<const Command> path_commands();
[[nodiscard]] std::span<const Command> output_commands();
[[nodiscard]] std::span<const Command> study_commands();
[[nodiscard]] std::vector<const Command*> all_commands();

// Returns null for an unknown name.
[[nodiscard]] const Command* find_command(std::string_view name);

}  // namespace occlod::viewer
