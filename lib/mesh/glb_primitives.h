// Meshes as glTF has them: a primitive for each material.
#pragma once

#include <vector>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// What has one material: its wedges, and its triangles by places in them.
struct GlbPrimitive {
  MaterialId material = 0;
  std::vector<WedgeId> wedges;
  std::vector<Triangle> triangles;

  // 65535 is no index.
  [[nodiscard]] bool has_short_indices() const noexcept { return wedges.size() < 65535; }
};

// A material's wedges come in the order of their first use; those of a mesh of one material as they are.
[[nodiscard]] std::vector<GlbPrimitive> glb_primitives(const TriangleMesh& mesh);

}  // namespace occlod
