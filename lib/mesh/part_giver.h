// Meshes that are generated component by component, as a whole or in parts.
#pragma once

#include <cstddef>

#include "occlod/generate.h"

namespace occlod {

// Components are appended to `part`, which is the whole mesh where there is no visitor.
class PartGiver {
 public:
  PartGiver() = default;
  explicit PartGiver(const PartVisitor& visit) : visit_(&visit) {}

  // After a component, which is never cut.
  void end_component() {
    constexpr std::size_t enough = std::size_t{1} << 18U;  // triangles
    if (visit_ != nullptr && part.triangle_count() >= enough) finish();
  }
  // After the last one.
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
