#include "object_textures.h"

#include <algorithm>
#include <map>
#include <utility>

#include "image_file.h"
#include "occlod/base.h"
#include "option_values.h"
#include "standard_streams.h"

namespace occlod::tool {
namespace {

// Accepts names of files from other systems, which have backslashes.
std::filesystem::path path_of(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

Image image_of(const Texture& texture, const std::filesystem::path& folder) {
  if (texture.file.empty()) return decode_image(texture.bytes, "an image within the mesh's file");
  return read_image(folder / path_of(texture.file));
}

// Throws Error when what was asked for is missing.
void check(TextureChoice choice, bool has_image, const std::string& name) {
  if (choice == TextureChoice::checker && !has_image)
    throw Error({name, "--texture", "has no texture coordinates", "leave the option out"});
  if (choice == TextureChoice::file && !has_image)
    throw Error({name, "--texture", "names no image", "leave the option out, or use --texture checker"});
}

}  // namespace

void add_texture_option(CLI::App& command, TextureChoice& choice, const std::string& what) {
  add_choice(command, "--texture", choice,
             {{"auto", TextureChoice::automatic},
              {"checker", TextureChoice::checker},
              {"file", TextureChoice::file},
              {"none", TextureChoice::none}},
             "What " + what +
                 " over meshes. auto: their materials, with the images that are found; file: the same, and a missing "
                 "image is a mistake; checker: squares on what has texture coordinates");
}

ObjectTextures::ObjectTextures(const TriangleMesh& mesh, const std::filesystem::path& folder, TextureChoice choice,
                               const TextureNote& note)
    : coordinates_(mesh.texture_coordinates) {
  if (!mesh.triangle_materials.empty()) {
    own_materials_.resize(mesh.wedge_count());
    const std::vector<Triangle>& triangles = mesh.wedge_triangles();
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int i = 0; i < 3; ++i) own_materials_[triangles[t][i]] = mesh.triangle_materials[t];
    vertex_materials_ = own_materials_;
  }
  load({mesh.materials, mesh.textures, mesh.texture_origin, !coordinates_.empty()}, folder, choice, note);
}

ObjectTextures::ObjectTextures(const HierarchyView& hierarchy, const std::filesystem::path& folder,
                               TextureChoice choice, const TextureNote& note)
    : coordinates_(hierarchy.texture_coordinates), vertex_materials_(hierarchy.wedge_materials) {
  load({hierarchy.materials, hierarchy.textures, hierarchy.texture_origin, !coordinates_.empty()}, folder, choice,
       note);
}

ObjectTextures::ObjectTextures(const WalkedObject& object, const std::filesystem::path& folder, TextureChoice choice,
                               const TextureNote& note)
    : coordinates_(object.texture_coordinates), vertex_materials_(object.wedge_materials) {
  const SurfaceMaterials& surface = object.surface;
  load({surface.materials, surface.textures, surface.texture_origin, !coordinates_.empty()}, folder, choice, note);
}

ObjectTextures::ObjectTextures(const hlod::HlodView& hlod, const std::filesystem::path& folder, TextureChoice choice,
                               const TextureNote& note) {
  load({hlod.materials, hlod.textures, hlod.texture_origin, hlod.has_texture_coordinates, hlod.image_materials}, folder,
       choice, note);
}

void ObjectTextures::load(const Source& source, const std::filesystem::path& folder, TextureChoice choice,
                          const TextureNote& note) {
  if (choice == TextureChoice::none) return;
  if (choice == TextureChoice::checker) {
    if (!source.has_coordinates) return;
    images_.push_back(std::make_shared<TextureImage>(checker_image(), TextureAddress{.origin = source.origin}));
    materials_.assign(std::max<std::size_t>(source.materials.size(), 1), {glm::vec3(1.0F), images_[0].get()});
    return;
  }
  std::vector<bool> is_shown(source.textures.size(), false);
  for (std::size_t m = 0; m < source.materials.size(); ++m)
    if (const TextureId texture = source.materials[m].texture;
        texture < is_shown.size() && (source.has_own_image.empty() || source.has_own_image[m] == 0))
      is_shown[texture] = true;
  for (const Texture& texture : source.textures) {
    images_.emplace_back();
    if (!source.has_coordinates || !is_shown[images_.size() - 1]) continue;
    try {
      images_.back() = std::make_shared<TextureImage>(image_of(texture, folder),
                                                      TextureAddress{texture.wrap_s, texture.wrap_t, source.origin});
    } catch (const Error& error) {
      if (choice == TextureChoice::file) throw;
      if (note) note(std::string(error.what()) + "; it is drawn without");
    }
  }
  for (const Material& material : source.materials)
    materials_.push_back({glm::vec3(material.base_color),
                          material.texture < images_.size() ? images_[material.texture].get() : nullptr});
}

bool ObjectTextures::has_image() const {
  return std::any_of(materials_.begin(), materials_.end(), [](const DrawMaterial& m) { return m.image != nullptr; });
}

SceneTextures::SceneTextures(const std::vector<LoadedObject>& objects, TextureChoice choice) {
  std::map<const Hierarchy*, std::shared_ptr<const ObjectTextures>> known;
  bool has_image = false, has_any = false;
  for (const LoadedObject& object : objects) {
    std::shared_ptr<const ObjectTextures>& textures = known[object.hierarchy.get()];
    if (!textures)
      textures = std::make_shared<ObjectTextures>(object.hierarchy->data(),
                                                  std::filesystem::path(object.source_name).parent_path(), choice,
                                                  [](const std::string& line) { print_note(line); });
    owners_.push_back(textures);
    textures_.push_back(textures->texture());
    has_image = has_image || textures->has_image();
    has_any = has_any || !textures_.back().materials.empty();
  }
  if (!has_any) textures_.clear();
  check(choice, has_image, objects.empty() ? "" : objects.front().source_name);
}

HlodTextures::HlodTextures(const std::vector<LoadedHlod>& hlods, const std::filesystem::path& folder,
                           TextureChoice choice)
    : shows_images_(choice == TextureChoice::automatic || choice == TextureChoice::file) {
  std::map<const hlod::Hlod*, std::shared_ptr<const ObjectTextures>> known;
  bool has_image = false, has_any = false;
  for (const LoadedHlod& object : hlods) {
    std::shared_ptr<const ObjectTextures>& textures = known[object.hlod.get()];
    if (!textures) {
      const std::filesystem::path file = object.source_name;
      textures = std::make_shared<ObjectTextures>(object.hlod->data(),
                                                  file.extension() == ".ohlod" ? file.parent_path() : folder, choice,
                                                  [](const std::string& line) { print_note(line); });
    }
    owners_.push_back(textures);
    materials_.push_back(textures->materials());
    has_image = has_image || textures->has_image() || !object.hlod->data().node_images.empty();
    has_any = has_any || !textures->materials().empty();
  }
  if (!has_any) materials_.clear();
  check(choice, has_image, hlods.empty() ? "" : hlods.front().source_name);
}

WalkTextures::WalkTextures(const WalkedFrame& frame, std::span<const std::filesystem::path> folders) {
  for (std::size_t i = 0; i < frame.objects.size(); ++i)
    objects_.push_back(
        std::make_shared<ObjectTextures>(frame.objects[i], i < folders.size() ? folders[i] : std::filesystem::path(),
                                         TextureChoice::automatic, [](const std::string& line) { print_note(line); }));
}

std::vector<ObjectTexture> WalkTextures::of(std::span<const ObjectRange> ranges) const {
  std::vector<ObjectTexture> textures;
  bool has_any = false;
  for (const ObjectRange& range : ranges) {
    textures.push_back(objects_[range.object]->texture());
    has_any = has_any || !textures.back().materials.empty();
  }
  if (!has_any) textures.clear();
  return textures;
}

}  // namespace occlod::tool
