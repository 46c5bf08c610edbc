#include "scene/scene_materials.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "occlod/core/error.h"

namespace occlod {

SceneMaterials::SceneMaterials(TriangleMesh& all, std::string name, std::filesystem::path folder)
    : all_(all), name_(std::move(name)), folder_(std::move(folder)) {}

void SceneMaterials::add_triangles(const TriangleMesh& mesh, const std::string& name) {
  const MaterialId first = first_of(mesh, name);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    all_.triangle_materials.push_back(static_cast<MaterialId>(first + mesh.material_of(t)));
}

MaterialId SceneMaterials::first_of(const TriangleMesh& mesh, const std::string& name) {
  const std::optional<std::string> key = mesh.materials.empty() ? std::nullopt : std::optional(name);
  const auto [found, is_new] = first_of_.try_emplace(key, MaterialId{0});
  if (is_new) found->second = add_materials(mesh, name);
  return found->second;
}

bool SceneMaterials::any() const {
  return std::ranges::any_of(first_of_, [](const auto& entry) { return entry.first.has_value(); });
}

void SceneMaterials::finish() {
  if (any()) return;
  all_.materials.clear();
  all_.triangle_materials.clear();
}

MaterialId SceneMaterials::add_materials(const TriangleMesh& mesh, const std::string& name) {
  const std::size_t first = all_.materials.size(), first_texture = all_.textures.size();
  const std::size_t count = std::max<std::size_t>(mesh.materials.size(), 1);  // plain where it has none
  constexpr std::size_t most = std::numeric_limits<MaterialId>::max();
  if (first + count > most || first_texture + mesh.textures.size() > most)
    throw Error({name_, name, "makes more than 65,535 materials or textures of all objects",
                 "use fewer objects that have their own"});
  all_.materials.insert(all_.materials.end(), mesh.materials.begin(), mesh.materials.end());
  all_.materials.resize(first + count);
  for (std::size_t m = first; m < all_.materials.size(); ++m)
    if (TextureId& texture = all_.materials[m].texture; texture != no_texture)
      texture = static_cast<TextureId>(texture + first_texture);
  for (Texture texture : mesh.textures) {
    texture.file = name_of_image(texture.file, std::filesystem::path(name).parent_path());
    all_.textures.push_back(std::move(texture));
  }
  return static_cast<MaterialId>(first);
}

std::string SceneMaterials::name_of_image(std::string file, const std::filesystem::path& mesh_folder) const {
  if (file.empty()) return file;
  std::replace(file.begin(), file.end(), '\\', '/');  // in files made on other systems
  const auto absolute = [](const std::filesystem::path& path) {
    return std::filesystem::absolute(path).lexically_normal();
  };
  const std::filesystem::path image = absolute(mesh_folder / file);
  const std::filesystem::path near = image.lexically_relative(absolute(folder_ / "."));
  return (near.empty() || *near.begin() == ".." ? image : near).generic_string();
}

}  // namespace occlod
