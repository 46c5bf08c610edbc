// The files of one command, checked before it does any work.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace occlod::tool {

// Nothing that is read may be overwritten, and nothing written twice, whatever the files are called: links are
// followed. Add what is read first.
class CommandFiles {
 public:
  // `what`: for messages, e.g. "the mesh". The file need not exist.
  void add_input(const std::string& what, const std::filesystem::path& path);
  // Throws CLI::ValidationError, which is wrong use, for a file that is read or written already; otherwise Error when
  // it could not be written.
  void add_output(const std::string& option, const std::filesystem::path& path);
  void add_mesh_output(const std::string& option, const std::filesystem::path& path);

 private:
  void refuse_twice(const std::string& option, const std::filesystem::path& path);

  std::map<std::string, std::string> inputs_;   // from the file's identity to what it is
  std::map<std::string, std::string> outputs_;  // from the file's identity to the option that names it
};

}  // namespace occlod::tool
