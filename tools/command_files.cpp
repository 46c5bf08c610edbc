#include "command_files.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <utility>

#include "mesh/mesh_files.h"
#include "occlod/base.h"
#include "occlod/mesh_file.h"
#include "scene/named_files.h"

namespace occlod::tool {
namespace fs = std::filesystem;

CommandFiles::CommandFiles()
    : guard_([this](const fs::path& path) {
        if (const std::string* const input = find_input(identity_of(path), path); input != nullptr)
          throw Error({path.string(), "", fmt::format("would be overwritten, but is {}", *input),
                       "choose another name for the output, or another folder"});
      }) {}

void CommandFiles::add_input(const std::string& what, const fs::path& path) {
  inputs_.emplace(identity_of(path), what);
  unread_.push_back(path);
}

void CommandFiles::add_output(const std::string& option, const fs::path& path) {
  AtomicFile::check(path);
  refuse_twice(option, path);
}

void CommandFiles::add_output(const std::string& option, const fs::path& path, const std::string& extension) {
  add_output(option, path);
  if (path.extension() != extension)
    throw CLI::ValidationError(
        option, fmt::format("{} does not end in {}, which is what is written; name it {}{}", path.string(), extension,
                            fs::path(path).replace_extension(extension).string(),
                            find_format(path) ? ", or write a mesh by 'occlod simplify'" : ""));
}

void CommandFiles::add_mesh_output(const std::string& option, const fs::path& path) {
  check_mesh_output(path);
  refuse_twice(option, path);
  if (find_format(path) == MeshFormat::obj) refuse_twice(option, fs::path(path).replace_extension(".mtl"));
}

void CommandFiles::refuse_twice(const std::string& option, const fs::path& path) {
  const std::string identity = identity_of(path);
  if (const std::string* const input = find_input(identity, path); input != nullptr)
    throw CLI::ValidationError(
        option, fmt::format("would overwrite {}, which is {}; name another file", path.string(), *input));
  if (const auto [other, is_new] = outputs_.emplace(identity, option); !is_new)
    throw CLI::ValidationError(
        option, fmt::format("would overwrite {}, which {} writes; name another file", path.string(), other->second));
}

const std::string* CommandFiles::find_input(const std::string& identity, const fs::path& path) {
  std::error_code unknown;
  if (!inputs_.contains(identity) && fs::exists(path, unknown))
    for (const fs::path& input : std::exchange(unread_, {}))
      for (const NamedFile& file : files_named_by(input)) inputs_.emplace(identity_of(file.path), file.role);
  const auto found = inputs_.find(identity);
  return found == inputs_.end() ? nullptr : &found->second;
}

}  // namespace occlod::tool
