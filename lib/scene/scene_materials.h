// The materials and textures of meshes that become one.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// The materials and textures of all meshes, each mesh's once.
class SceneMaterials {
 public:
  // `all` gets them; names of image files become relative to `folder`, or absolute where they lie elsewhere. `name`: of
  // the whole, for errors.
  SceneMaterials(TriangleMesh& all, std::string name, std::filesystem::path folder);

  // Those of the triangles of a mesh, the last ones of `all`. `name`: of its source.
  void add_triangles(const TriangleMesh& mesh, const std::string& name);

  // The first of the mesh's materials among those of all. Throws Error when there would be too many.
  MaterialId first_of(const TriangleMesh& mesh, const std::string& name);

  // Whether any mesh so far has some.
  [[nodiscard]] bool any() const;

  // After all objects. A scene without materials says nothing of them.
  void finish();

 private:
  MaterialId add_materials(const TriangleMesh& mesh, const std::string& name);
  [[nodiscard]] std::string name_of_image(std::string file, const std::filesystem::path& mesh_folder) const;

  TriangleMesh& all_;
  std::string name_;
  std::filesystem::path folder_;
  std::map<std::optional<std::string>, MaterialId> first_of_;  // by the mesh's name; nothing: of those that have none
};

}  // namespace occlod
