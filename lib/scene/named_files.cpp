#include "scene/named_files.h"

#include <fmt/format.h>

#include <set>
#include <span>
#include <string>
#include <variant>

#include "mesh/mesh_files.h"
#include "occlod/build_hierarchy.h"
#include "occlod/node_store.h"
#include "occlod/scene.h"
#include "scene/mesh_source.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

// Returns the image files that a hierarchy or an HLOD names.
std::vector<fs::path> images_of_built(const fs::path& file) {
  std::vector<fs::path> images;
  const auto add = [&](std::span<const Texture> textures) {
    for (const Texture& texture : textures)
      if (!texture.file.empty()) images.push_back(file.parent_path() / texture.file);
  };
  if (is_olod_file(file)) add(read_olod(file).hierarchy.data().textures);
  if (is_ohlod_file(file)) add(read_ohlod(file).hlod.data().textures);
  return images;
}

void add_mesh_files(const fs::path& mesh, std::vector<NamedFile>& files) {
  const char* const contents = find_format(mesh) == MeshFormat::obj ? "material library" : "buffer";
  for (const fs::path& file : files_beside(mesh))
    files.push_back({file, fmt::format("a {} of {}", contents, mesh.string())});
  for (const std::vector<fs::path>& images : {images_of(mesh), images_of_built(mesh)})
    for (const fs::path& image : images) files.push_back({image, fmt::format("an image of {}", mesh.string())});
}

void add_scene_files(const fs::path& scene, std::vector<NamedFile>& files) {
  std::set<std::string> names;
  for (const SceneObject& object : read_scene(scene).objects)
    if (const auto* const source = std::get_if<MeshFile>(&object.source))
      names.insert(source->names.begin(), source->names.end());
  for (const std::string& name : names) {
    const fs::path mesh = find_mesh(name, scene.parent_path());
    if (mesh.empty()) continue;
    files.push_back({mesh, fmt::format("a mesh of {}", scene.string())});
    add_mesh_files(mesh, files);
  }
}

}  // namespace

std::vector<NamedFile> files_named_by(const fs::path& input) {
  std::vector<NamedFile> files;
  std::error_code unknown;
  if (!fs::is_regular_file(input, unknown)) return files;
  is_scene_file(input) ? add_scene_files(input, files) : add_mesh_files(input, files);
  return files;
}

}  // namespace occlod
