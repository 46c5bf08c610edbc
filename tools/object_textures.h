// Reads and decodes the images of meshes, ready to be drawn.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "occlod/cell_walker.h"
#include "occlod/hierarchy.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"
#include "occlod/picture.h"
#include "occlod/scene.h"

namespace CLI {
class App;
}

namespace occlod::tool {

enum class TextureChoice {
  automatic,  // those of the files, as far as they are found
  file,       // those of the files; a missing one is an error
  checker,    // a checker on everything that has texture coordinates
  none
};

// Adds --texture. `what` names the outputs that show textures.
void add_texture_option(CLI::App& command, TextureChoice& choice, const std::string& what);

// Is called with one line about each image that is left out.
using TextureNote = std::function<void(const std::string& line)>;

// Holds the textures of one mesh or hierarchy. The result of texture() is valid as long as this object.
class ObjectTextures {
 public:
  // `folder` is that of the file, to which the names of its images are relative. Keeps views of the arrays. Throws
  // Error with `file` only.
  ObjectTextures(const TriangleMesh& mesh, const std::filesystem::path& folder, TextureChoice choice,
                 const TextureNote& note);
  ObjectTextures(const HierarchyView& hierarchy, const std::filesystem::path& folder, TextureChoice choice,
                 const TextureNote& note);
  ObjectTextures(const WalkedObject& object, const std::filesystem::path& folder, TextureChoice choice,
                 const TextureNote& note);
  // This provides only materials(), because each node has texture coordinates of its own, without the images that nodes
  // have themselves.
  ObjectTextures(const hlod::HlodView& hlod, const std::filesystem::path& folder, TextureChoice choice,
                 const TextureNote& note);
  ~ObjectTextures() = default;
  ObjectTextures(const ObjectTextures&) = delete;
  ObjectTextures& operator=(const ObjectTextures&) = delete;

  [[nodiscard]] std::span<const DrawMaterial> materials() const { return materials_; }
  [[nodiscard]] ObjectTexture texture() const { return {coordinates_, vertex_materials_, materials_}; }
  // Returns whether an image is drawn.
  [[nodiscard]] bool has_image() const;

 private:
  struct Source {
    std::span<const Material> materials;
    std::span<const Texture> textures;
    TextureOrigin origin;
    bool has_coordinates;
    std::span<const std::uint8_t> has_own_image = {};  // by material: it is drawn by other images; empty: none is
  };
  void load(const Source& source, const std::filesystem::path& folder, TextureChoice choice, const TextureNote& note);

  std::span<const glm::vec2> coordinates_;
  std::span<const MaterialId> vertex_materials_;
  std::vector<MaterialId> own_materials_;  // per wedge of a mesh
  std::vector<DrawMaterial> materials_;
  std::vector<std::shared_ptr<const TextureImage>> images_;
};

// Holds the textures of all objects of a scene, in their order; objects with one hierarchy share them. Prints notes on
// standard error.
class SceneTextures {
 public:
  // Throws Error like ObjectTextures, and when no object has what `checker` or `file` needs.
  SceneTextures(const std::vector<LoadedObject>& objects, TextureChoice choice);

  // Returns one per object; none when no object has a texture or material.
  [[nodiscard]] std::span<const ObjectTexture> textures() const { return textures_; }

 private:
  std::vector<std::shared_ptr<const ObjectTextures>> owners_;
  std::vector<ObjectTexture> textures_;
};

// Holds the textures of HLODs.
class HlodTextures {
 public:
  // `folder` is that of the scene, for objects that were flattened. Throws Error like SceneTextures.
  HlodTextures(const std::vector<LoadedHlod>& hlods, const std::filesystem::path& folder, TextureChoice choice);

  // Returns one entry per HLOD; none when no HLOD has a texture or material.
  [[nodiscard]] std::span<const std::span<const DrawMaterial>> materials() const { return materials_; }
  // Returns whether images are those of the files, which nodes may have of their own.
  [[nodiscard]] bool shows_images() const { return shows_images_; }

 private:
  bool shows_images_;
  std::vector<std::shared_ptr<const ObjectTextures>> owners_;
  std::vector<std::span<const DrawMaterial>> materials_;
};

// Holds the textures of what a frame of a walk draws.
class WalkTextures {
 public:
  // `folders` are those of the meshes, per object, as far as known. The frame must outlive this object. Prints notes on
  // standard error.
  WalkTextures(const WalkedFrame& frame, std::span<const std::filesystem::path> folders);

  // Returns one per range, valid as long as this object; none when no object has a texture or material.
  [[nodiscard]] std::vector<ObjectTexture> of(std::span<const ObjectRange> ranges) const;

 private:
  std::vector<std::shared_ptr<const ObjectTextures>> objects_;
};

}  // namespace occlod::tool
