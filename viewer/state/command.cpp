#include "command.h"

namespace occlod::viewer {

std::vector<const Command*> all_commands() {
  std::vector<const Command*> all;
  for (const auto& group : {scene_commands(), camera_commands(), path_commands(), output_commands(), study_commands()})
    for (const Command& command : group) all.push_back(&command);
  return all;
}

const Command* find_command(std::string_view name) {
  for (const Command* command : all_commands())
    if (command->name == name) return command;
  return nullptr;
}

}  // namespace occlod::viewer
