// The images of meshes, read and decoded, ready to be drawn.
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
  file,       // those of the files; one that is missing is a mistake
  checker,    // a checker on all that has texture coordinates
  none
};

// --texture. `what`: the outputs that have them.
void add_texture_option(CLI::App& command, TextureChoice& choice, const std::string& what);

// Told in one line of an image that is left out.
using TextureNote = std::function<void(const std::string& line)>;

// Of one mesh or hierarchy. What texture() returns lives as long as this.
class ObjectTextures {
 public:
  // folder: of the file, where the names of its images start. Keeps views of the arrays. Throws Error with `file` only.
  ObjectTextures(const TriangleMesh& mesh, const std::filesystem::path& folder, TextureChoice choice,
                 const TextureNote& note);
  ObjectTextures(const HierarchyView& hierarchy, const std::filesystem::path& folder, TextureChoice choice,
                 const TextureNote& note);
  ObjectTextures(const WalkedObject& object, const std::filesystem::path& folder, TextureChoice choice,
                 const TextureNote& note);
  // Only materials(): each node has texture coordinates of its own.
  ObjectTextures(const hlod::HlodView& hlod, const std::filesystem::path& folder, TextureChoice choice,
                 const TextureNote& note);
  ~ObjectTextures() = default;
  ObjectTextures(const ObjectTextures&) = delete;
  ObjectTextures& operator=(const ObjectTextures&) = delete;

  [[nodiscard]] std::span<const DrawMaterial> materials() const { return materials_; }
  [[nodiscard]] ObjectTexture texture() const { return {coordinates_, vertex_materials_, materials_}; }
  // Whether an image is drawn.
  [[nodiscard]] bool has_image() const;

 private:
  struct Source {
    std::span<const Material> materials;
    std::span<const Texture> textures;
    TextureOrigin origin;
    bool has_coordinates;
  };
  void load(const Source& source, const std::filesystem::path& folder, TextureChoice choice, const TextureNote& note);

  std::span<const glm::vec2> coordinates_;
  std::span<const MaterialId> vertex_materials_;
  std::vector<MaterialId> own_materials_;  // by wedge, of a mesh
  std::vector<DrawMaterial> materials_;
  std::vector<std::shared_ptr<const TextureImage>> images_;
};

// Of all objects of a scene, in their order; objects with one hierarchy share theirs. Notes go to standard error.
class SceneTextures {
 public:
  // Throws Error as ObjectTextures does, and when no object has what `checker` or `file` needs.
  SceneTextures(const std::vector<LoadedObject>& objects, TextureChoice choice);

  // One for each object; empty when none has a texture or material.
  [[nodiscard]] std::span<const ObjectTexture> textures() const { return textures_; }

 private:
  std::vector<std::shared_ptr<const ObjectTextures>> owners_;
  std::vector<ObjectTexture> textures_;
};

// The same of HLODs.
class HlodTextures {
 public:
  // `folder`: of the scene, for objects that were flattened. Throws Error as SceneTextures does.
  HlodTextures(const std::vector<LoadedHlod>& hlods, const std::filesystem::path& folder, TextureChoice choice);

  // One for each HLOD; empty when none has a texture or material.
  [[nodiscard]] std::span<const std::span<const DrawMaterial>> materials() const { return materials_; }

 private:
  std::vector<std::shared_ptr<const ObjectTextures>> owners_;
  std::vector<std::span<const DrawMaterial>> materials_;
};

// Of what a frame of a walk draws.
class WalkTextures {
 public:
  // `folders`: of the meshes, by object, as far as they are known. The frame outlives this. Notes go to standard error.
  WalkTextures(const WalkedFrame& frame, std::span<const std::filesystem::path> folders);

  // One for each range; nothing when no object has a texture or material. As long as this.
  [[nodiscard]] std::vector<ObjectTexture> of(std::span<const ObjectRange> ranges) const;

 private:
  std::vector<std::shared_ptr<const ObjectTextures>> objects_;
};

}  // namespace occlod::tool
