#include "command_files.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/atomic_file.h"
#include "occlod/mesh_file.h"

namespace occlod::tool {
namespace fs = std::filesystem;

void CommandFiles::add_input(const std::string& what, const fs::path& path) {
  inputs_.emplace(identity_of(path), what);
}

void CommandFiles::add_output(const std::string& option, const fs::path& path) {
  refuse_twice(option, path);
  AtomicFile::check(path);
}

void CommandFiles::add_mesh_output(const std::string& option, const fs::path& path) {
  refuse_twice(option, path);
  check_mesh_output(path);
}

void CommandFiles::refuse_twice(const std::string& option, const fs::path& path) {
  const std::string identity = identity_of(path);
  if (const auto input = inputs_.find(identity); input != inputs_.end())
    throw CLI::ValidationError(
        option, fmt::format("would overwrite {}, which is {}; name another file", path.string(), input->second));
  if (const auto [other, is_new] = outputs_.emplace(identity, option); !is_new)
    throw CLI::ValidationError(
        option, fmt::format("would overwrite {}, which {} writes; name another file", path.string(), other->second));
}

}  // namespace occlod::tool
