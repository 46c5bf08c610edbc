#include "shown_mesh.h"

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "occlod/build_hierarchy.h"
#include "occlod/scene.h"

namespace occlod::viewer {
namespace {

// Returns where names of images start: the first file that the object was made of, or its name without one.
std::string source_of(const PlacedObject& object) {
  for (const SceneObject& part : object.parts)
    if (const auto* mesh = std::get_if<MeshFile>(&part.source)) return mesh->names[0];
  return object.name;
}

// Each vertex of the front has a place of its own in each node; clean() joins them.
TriangleMesh mesh_of_front(const FrontObject& front, const hlod::HlodView& data) {
  TriangleMesh mesh;
  mesh.positions = front.positions;
  mesh.normals = front.normals;
  mesh.colors = front.colors;
  mesh.texture_coordinates = front.texture_coordinates;
  mesh.triangles = front.triangles;
  if (!front.materials.empty())
    for (const Triangle& t : front.triangles) mesh.triangle_materials.push_back(front.materials[t.x]);
  mesh.materials.assign(data.materials.begin(), data.materials.end());
  mesh.textures.assign(data.textures.begin(), data.textures.end());
  mesh.texture_origin = data.texture_origin;
  mesh.origin = data.origin;
  return clean(std::move(mesh), MeshReport{}, "the mesh that is shown").mesh;
}

// Returns an empty mesh for an object of which nothing is shown.
TriangleMesh mesh_of_object(const RefinedFrame& frame, std::size_t i) {
  const PlacedObject& object = (*frame.job.objects)[i];
  if (!object.hlod) return mesh_of(*object.mesh->hierarchy, frame.sides[0].refinement.objects[i].triangles);
  const FrontObject& front = frame.hlod_sides[0].front->objects[i];
  return front.triangles.empty() ? TriangleMesh() : mesh_of_front(front, object.hlod->hlod->data());
}

}  // namespace

TriangleMesh shown_mesh(const RefinedFrame& frame, const std::filesystem::path& file) {
  const Objects& objects = *frame.job.objects;
  std::vector<TriangleMesh> meshes;
  meshes.reserve(objects.size());
  std::vector<PlacedMesh> placed;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    meshes.push_back(mesh_of_object(frame, i));
    if (!meshes.back().triangles.empty())
      placed.push_back({&meshes.back(), objects[i].object_to_world, source_of(objects[i])});
  }
  return placed.empty() ? TriangleMesh() : join_meshes(placed, file.parent_path(), file.string());
}

}  // namespace occlod::viewer
