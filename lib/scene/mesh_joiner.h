// Meshes at their places as one, a vertex for each wedge.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <string>

#include "occlod/mesh/triangle_mesh.h"
#include "scene/scene_materials.h"

namespace occlod {

// All but materials. Where `all` has texture coordinates of meshes before, those without get (0, 0) once others follow.
void append_placed(TriangleMesh& all, const TriangleMesh& mesh, const glm::dmat4& object_to_world);

class MeshJoiner {
 public:
  // `name`: of the whole, for errors. `folder`: see SceneMaterials.
  MeshJoiner(std::string name, const std::filesystem::path& folder);
  MeshJoiner(const MeshJoiner&) = delete;
  MeshJoiner& operator=(const MeshJoiner&) = delete;
  ~MeshJoiner() = default;

  // `source_name`: of its file or generator; meshes of one name share their materials. Throws Error when all together
  // have 2^32 vertices or more, or too many materials.
  void add(const TriangleMesh& mesh, const glm::dmat4& object_to_world, const std::string& source_name);

  // Without extra wedges. Normals and colours only when every mesh has them.
  [[nodiscard]] TriangleMesh finish();

 private:
  std::string name_;
  TriangleMesh all_;
  SceneMaterials materials_;  // of all_
  std::size_t count_ = 0;     // of meshes
};

}  // namespace occlod
