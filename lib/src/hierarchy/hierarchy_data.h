// The arrays of a hierarchy where they are built.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "core/large_vector.h"
#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

// The fields of a HierarchyView.
struct HierarchyData {
  LargeVector<glm::vec3> positions;
  LargeVector<glm::vec3> normals;
  LargeVector<glm::u8vec4> colors;
  LargeVector<SplitNode> nodes;
  LargeVector<std::uint32_t> stars;
  LargeVector<SplitId> roots;
  LargeVector<Triangle> base_faces;
  Box box;
  std::uint64_t input_triangle_count = 0;
  std::uint64_t face_count = 0;
  float error_bound = 0.0F;
};

[[nodiscard]] HierarchyView view_of(const HierarchyData& data);
// Takes arrays whose sizes and indices fit together.
[[nodiscard]] Hierarchy make_hierarchy(HierarchyData data);
[[nodiscard]] HierarchyData copy_data(const Hierarchy& hierarchy);

}  // namespace occlod
