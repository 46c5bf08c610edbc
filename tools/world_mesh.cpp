#include "world_mesh.h"

#include "occlod/build_hierarchy.h"
#include "occlod/scene.h"

namespace occlod::tool {

TriangleMesh world_mesh(const std::vector<LoadedObject>& objects, const Refinement& refinement,
                        const std::filesystem::path& file) {
  std::vector<TriangleMesh> meshes;
  for (std::size_t i = 0; i < objects.size(); ++i)
    meshes.push_back(mesh_of(*objects[i].hierarchy, refinement.objects[i].triangles));
  std::vector<PlacedMesh> placed;
  for (std::size_t i = 0; i < objects.size(); ++i)
    placed.push_back({&meshes[i], objects[i].object_to_world, objects[i].source_name});
  return join_meshes(placed, file.parent_path(), file.string());
}

}  // namespace occlod::tool
