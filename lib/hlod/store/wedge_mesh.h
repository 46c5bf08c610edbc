// The input of an HLOD while it is built, and the wedges that its levels add to it.
#pragma once

#include <cstddef>
#include <type_traits>
#include <vector>

#include "base/large_vector.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod::hlod {

// The arrays of a TriangleMesh, which may be larger than memory. Vertices stay; wedges are added where a collapse
// stretches a chart over a vertex that had none in it.
struct WedgeMesh {
  LargeVector<glm::vec3> positions;
  LargeVector<glm::vec3> normals;
  LargeVector<glm::u8vec4> colors;
  LargeVector<glm::vec2> texture_coordinates;
  LargeVector<VertexId> extra_wedges;  // their vertices; those that were added in no order
  LargeVector<Triangle> triangles;
  LargeVector<Triangle> corners;
  LargeVector<MaterialId> wedge_materials;  // by wedge; empty when triangles name none
  std::vector<Material> materials;
  std::vector<Texture> textures;
  TextureOrigin texture_origin = TextureOrigin::bottom_left;

  [[nodiscard]] std::size_t vertex_count() const noexcept { return positions.size() - extra_wedges.size(); }
  [[nodiscard]] std::size_t wedge_count() const noexcept { return positions.size(); }
  [[nodiscard]] VertexId vertex_of(WedgeId wedge) const noexcept {
    return wedge < vertex_count() ? wedge : extra_wedges[wedge - vertex_count()];
  }
  // Whether a vertex may have several wedges.
  [[nodiscard]] bool has_seams() const noexcept { return !extra_wedges.empty(); }
  // Whether simplification takes attributes into account.
  [[nodiscard]] bool has_wedge_attributes() const noexcept { return has_seams() || !texture_coordinates.empty(); }

  // A wedge of `vertex` with the attributes and the material of `like`.
  void add(VertexId vertex, WedgeId like) {
    const auto repeat = [](auto& values, WedgeId wedge) {
      if (!values.empty()) values.push_back(typename std::decay_t<decltype(values)>::value_type(values[wedge]));
    };
    repeat(positions, vertex);
    repeat(normals, like);
    repeat(colors, like);
    repeat(texture_coordinates, like);
    repeat(wedge_materials, like);
    extra_wedges.push_back(vertex);
  }
};

// The same mesh with its vertices along a Morton curve, as in_spatial_order() has it. O(n).
[[nodiscard]] WedgeMesh to_wedge_mesh(const TriangleMesh& mesh, unsigned threads);

}  // namespace occlod::hlod
