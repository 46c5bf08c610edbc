// What threads share of attributes while they simplify a mesh that has texture coordinates or seams.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "splits/corner_map.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// Whether a mesh has attributes that simplification takes into account.
[[nodiscard]] inline bool has_wedge_attributes(const TriangleMesh& mesh) {
  return !mesh.extra_wedges.empty() || !mesh.texture_coordinates.empty();
}

// The material of each wedge; empty when triangles name none.
[[nodiscard]] std::vector<MaterialId> wedge_materials(const TriangleMesh& mesh);

// Indexed by wedge or by vertex of the input. A worker touches only vertices of its block.
struct AttributeState {
  // `scale`: from object units to those of the state. `mesh` outlives it.
  AttributeState(const TriangleMesh& mesh, float scale);

  const TriangleMesh& input;
  std::vector<MaterialId> materials;   // by wedge, or empty
  std::vector<float> texture_lengths;  // by wedge: of a step of 1 in texture space, in the state's scale
  std::vector<float> extents2;         // by wedge: a sixth of the area of its chart; what has left it slips no farther
  CornerMap corners;
  std::vector<float> sums;  // by vertex: weight times squared deviation, over all collapses that led to it
};

}  // namespace occlod
