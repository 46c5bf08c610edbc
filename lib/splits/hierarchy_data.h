// The arrays of a hierarchy where they are built.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "base/large_vector.h"
#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

// The fields of a HierarchyView.
struct HierarchyData {
  UninitializedVector<glm::vec3> positions;
  UninitializedVector<glm::vec3> normals;
  UninitializedVector<glm::u8vec4> colors;
  UninitializedVector<SplitNode> nodes;
  UninitializedVector<std::uint32_t> stars;
  UninitializedVector<SplitId> roots;
  UninitializedVector<Triangle> base_faces;
  Box box;
  std::uint64_t input_triangle_count = 0;
  std::uint64_t face_count = 0;
  float error_bound = 0.0F;
  UninitializedVector<glm::vec2> texture_coordinates;
  UninitializedVector<VertexId> extra_wedges;
  UninitializedVector<MaterialId> wedge_materials;
  UninitializedVector<std::uint32_t> corners;
  UninitializedVector<std::uint32_t> corner_starts;
  UninitializedVector<Triangle> base_corners;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  UninitializedVector<std::uint16_t> attribute_errors;
  TextureOrigin texture_origin = TextureOrigin::bottom_left;
};

[[nodiscard]] HierarchyView view_of(const HierarchyData& data);
// Takes arrays whose sizes and indices fit together.
[[nodiscard]] Hierarchy make_hierarchy(HierarchyData data);
[[nodiscard]] HierarchyData copy_data(const Hierarchy& hierarchy);

}  // namespace occlod
