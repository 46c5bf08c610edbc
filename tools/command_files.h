// Checks the files of one command before it does any work.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace occlod::tool {

// Makes sure that no input is overwritten and no output written twice, under whatever names: links are followed. Add
// inputs first.
class CommandFiles {
 public:
  // `what` names the file in messages, e.g. "the mesh". The file need not exist.
  void add_input(const std::string& what, const std::filesystem::path& path);
  // Throws CLI::ValidationError, for wrong use, when the file is already an input or output, and Error when it cannot
  // be written.
  void add_output(const std::string& option, const std::filesystem::path& path);
  void add_mesh_output(const std::string& option, const std::filesystem::path& path);

 private:
  void refuse_twice(const std::string& option, const std::filesystem::path& path);

  std::map<std::string, std::string> inputs_;   // from the file's identity to what it is
  std::map<std::string, std::string> outputs_;  // from the file's identity to the option that names it
};

}  // namespace occlod::tool
