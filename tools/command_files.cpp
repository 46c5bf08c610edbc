#include "command_files.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <set>
#include <span>
#include <utility>
#include <variant>

#include "mesh/mesh_files.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/mesh_file.h"
#include "occlod/node_store.h"
#include "occlod/scene.h"
#include "scene/mesh_source.h"

namespace occlod::tool {
namespace {

namespace fs = std::filesystem;

// Returns the image files that a hierarchy or an HLOD names.
std::vector<fs::path> images_of_built(const fs::path& file) {
  std::vector<Texture> textures;
  const auto keep = [&](std::span<const Texture> named) { textures.assign(named.begin(), named.end()); };
  if (is_olod_file(file)) keep(read_olod(file).hierarchy.data().textures);
  if (is_ohlod_file(file)) keep(read_ohlod(file).hlod.data().textures);
  std::vector<fs::path> images;
  for (const Texture& texture : textures)
    if (!texture.file.empty()) images.push_back(file.parent_path() / texture.file);
  return images;
}

}  // namespace

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
    for (const fs::path& file : std::exchange(unread_, {}))
      is_scene_file(file) ? add_scene_files(file) : add_mesh_files(file);
  const auto found = inputs_.find(identity);
  return found == inputs_.end() ? nullptr : &found->second;
}

void CommandFiles::add_scene_files(const fs::path& scene) {
  std::set<std::string> names;
  for (const SceneObject& object : read_scene(scene).objects)
    if (const auto* const source = std::get_if<MeshFile>(&object.source))
      names.insert(source->names.begin(), source->names.end());
  for (const std::string& name : names) {
    const fs::path mesh = find_mesh(name, scene.parent_path());
    if (mesh.empty()) continue;
    inputs_.emplace(identity_of(mesh), fmt::format("a mesh of {}", scene.string()));
    add_mesh_files(mesh);
  }
}

void CommandFiles::add_mesh_files(const fs::path& mesh) {
  std::error_code unknown;
  if (!fs::is_regular_file(mesh, unknown)) return;  // whoever reads it reports that
  const bool is_obj = find_format(mesh) == MeshFormat::obj;
  for (const fs::path& file : files_beside(mesh))
    inputs_.emplace(identity_of(file),
                    fmt::format("a {} of {}", is_obj ? "material library" : "buffer", mesh.string()));
  for (const std::vector<fs::path>& images : {images_of(mesh), images_of_built(mesh)})
    for (const fs::path& image : images)
      inputs_.emplace(identity_of(image), fmt::format("an image of {}", mesh.string()));
}

}  // namespace occlod::tool
