// Checks the files of one command before it does any work, and guards them while it works.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/atomic_file.h"

namespace occlod::tool {

// The list of all files that a command reads and writes. Makes sure that no input is overwritten and no output written
// twice, under whatever names: links are followed. With an input comes what it names: the meshes of a scene, their
// material libraries, buffers and images. Add inputs first. While the list lives, whatever this thread writes is
// checked too, as the images beside a mesh, whose names are not known before.
class CommandFiles {
 public:
  CommandFiles();

  // `what` names the file in messages, e.g. "the mesh". The file need not exist.
  void add_input(const std::string& what, const std::filesystem::path& path);
  // Throws CLI::ValidationError, for wrong use, when the file is already an input or output, and Error when it cannot
  // be written.
  void add_output(const std::string& option, const std::filesystem::path& path);
  // The same of a format that is known by its extension, like ".olod": no other may be named.
  void add_output(const std::string& option, const std::filesystem::path& path, const std::string& extension);
  void add_mesh_output(const std::string& option, const std::filesystem::path& path);

 private:
  void refuse_twice(const std::string& option, const std::filesystem::path& path);
  // Returns what the input is that has this identity; null if none has. Only an output that exists can be an input, so
  // inputs are not read before there is one.
  const std::string* find_input(const std::string& identity, const std::filesystem::path& path);

  std::map<std::string, std::string> inputs_;   // from the file's identity to what it is
  std::map<std::string, std::string> outputs_;  // from the file's identity to the option that names it
  std::vector<std::filesystem::path> unread_;   // inputs whose files are not in the list yet
  WriteGuard guard_;
};

}  // namespace occlod::tool
