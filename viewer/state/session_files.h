// Tracks the files that a session reads and writes, so that it overwrites none of them unasked.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/strict_json.h"
#include "objects.h"

namespace occlod::viewer {

enum class OutputKind { scene, picture, numbers, mesh };

class SessionFiles {
 public:
  // `what` names the file in messages, e.g. "the script". The file need not exist.
  void add_input(const std::filesystem::path& file, const std::string& what);
  void add_scene(const std::filesystem::path& file);  // that was opened

  // Returns the file that an action names at `place`, to be written next. Throws Error at `place` when it is a file of
  // an open object, another input, or an output of another kind. A scene may be saved over a scene, and every output
  // written again.
  [[nodiscard]] std::filesystem::path output(const JsonPlace& place, OutputKind kind, const Objects& objects);
  // Checks files to write in a folder that the action names, in the same way.
  void add_outputs(const JsonPlace& place, const std::vector<std::filesystem::path>& files, OutputKind kind,
                   const Objects& objects);

 private:
  struct Used {
    std::filesystem::path file;
    std::string what;
    bool is_scene = false;
  };
  struct Written {
    std::filesystem::path file;
    OutputKind kind;
  };
  // Returns what `file` is if it must not be overwritten; empty if it may be.
  [[nodiscard]] std::string conflict(const std::filesystem::path& file, OutputKind kind, const Objects& objects) const;

  std::vector<Used> inputs_;
  std::vector<Written> outputs_;
};

}  // namespace occlod::viewer
