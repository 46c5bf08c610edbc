// The images of meshes, read and decoded, ready to be drawn.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/mesh/triangle_mesh.h"
#include "occlod/picture/texture_image.h"
#include "occlod/scene/scene.h"

namespace occlod::tool {

enum class TextureChoice {
  automatic,  // those of the files, as far as they are found
  file,       // those of the files; one that is missing is a mistake
  checker,    // a checker on all that has texture coordinates
  none
};

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
  ~ObjectTextures() = default;
  ObjectTextures(const ObjectTextures&) = delete;
  ObjectTextures& operator=(const ObjectTextures&) = delete;

  [[nodiscard]] ObjectTexture texture() const { return {coordinates_, vertex_materials_, materials_}; }
  // Whether an image is drawn.
  [[nodiscard]] bool has_image() const;

 private:
  struct Source {
    std::span<const Material> materials;
    std::span<const Texture> textures;
    TextureOrigin origin;
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

}  // namespace occlod::tool
