// Gives generated meshes as a whole or in parts.
#pragma once

#include <cstddef>

#include "occlod/generate.h"

namespace occlod {

// Collects components in `part`, and passes parts to a visitor; without a visitor `part` becomes the whole mesh.
class PartGiver {
 public:
  PartGiver() = default;
  explicit PartGiver(const PartVisitor& visit) : visit_(&visit) {}

  // Call after each component; components are never cut.
  void end_component() {
    constexpr std::size_t enough = std::size_t{1} << 18U;  // triangles
    if (visit_ != nullptr && part.triangle_count() >= enough) finish();
  }
  // Call after the last component.
  void finish() {
    if (part.triangles.empty()) return;
    (*visit_)(part, 0);
    part.positions.clear();
    part.triangles.clear();
  }

  TriangleMesh part;

 private:
  const PartVisitor* visit_ = nullptr;
};

}  // namespace occlod
