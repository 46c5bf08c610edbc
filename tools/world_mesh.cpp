#include "world_mesh.h"

#include <algorithm>
#include <glm/mat3x3.hpp>
#include <utility>
#include <vector>

namespace occlod::tool {
namespace {

void append(TriangleMesh& mesh, const DrawObject& object, bool with_colors) {
  const bool mirrored = glm::determinant(glm::dmat3(object.object_to_world)) < 0.0;
  std::vector<VertexId> new_ids(object.positions.size(), no_id);
  for (Triangle triangle : object.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      VertexId& id = new_ids[triangle[corner]];
      if (id == no_id) {
        id = static_cast<VertexId>(mesh.positions.size());
        mesh.positions.emplace_back(object.object_to_world * glm::dvec4(object.positions[triangle[corner]], 1.0));
        if (with_colors) mesh.colors.push_back(object.colors[triangle[corner]]);
      }
      triangle[corner] = id;
    }
    if (mirrored) std::swap(triangle.y, triangle.z);
    mesh.triangles.push_back(triangle);
  }
}

}  // namespace

TriangleMesh world_mesh(std::span<const DrawObject> objects) {
  const bool with_colors =
      std::none_of(objects.begin(), objects.end(), [](const DrawObject& object) { return object.colors.empty(); });
  TriangleMesh mesh;
  for (const DrawObject& object : objects) append(mesh, object, with_colors);
  return mesh;
}

}  // namespace occlod::tool
