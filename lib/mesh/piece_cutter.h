// Cuts large meshes into pieces.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "base/large_vector.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// Of a mesh, wherever they lie. Attributes are empty or one per wedge.
struct MeshArrays {
  std::span<const glm::vec3> positions;  // one per wedge
  std::span<const glm::vec3> normals;
  std::span<const glm::u8vec4> colors;
  std::span<const glm::vec2> texture_coordinates;
  std::span<const Triangle> triangles;             // into wedges
  std::span<const MaterialId> triangle_materials;  // empty or one per triangle
  TextureOrigin texture_origin = TextureOrigin::bottom_left;
};

[[nodiscard]] inline MeshArrays arrays_of(const TriangleMesh& mesh) {
  return {mesh.positions,          mesh.normals,       mesh.colors, mesh.texture_coordinates, mesh.wedge_triangles(),
          mesh.triangle_materials, mesh.texture_origin};
}

class PieceCutter {
 public:
  // The arrays outlive it.
  explicit PieceCutter(const MeshArrays& mesh) : mesh_(mesh), local_(mesh.positions.size(), no_id) {}

  // A run of triangles and the wedges that they use as vertices, in the order of their first use. Without materials and
  // textures.
  [[nodiscard]] TriangleMesh cut(std::size_t begin, std::size_t end);

 private:
  MeshArrays mesh_;
  LargeVector<VertexId> local_;  // by wedge, of the piece that is cut
  std::vector<WedgeId> wedges_;
};

}  // namespace occlod
