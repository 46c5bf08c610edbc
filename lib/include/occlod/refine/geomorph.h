// Vertices that slide from their parents to their own positions.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/core/ids.h"
#include "occlod/refine/refinement.h"

namespace occlod {

// The positions at which a mesh's vertices are drawn while some of them slide.
class MorphedPositions {
 public:
  // Copies `positions` (object space), which must also outlive this.
  explicit MorphedPositions(std::span<const glm::vec3> positions);

  // Takes the geomorphs of one call of Refiner::update() in place of those of the call before. O(n log n) for n of
  // both.
  void update(std::span<const Geomorph> geomorphs);

  // Of all vertices, object space, after the last update().
  [[nodiscard]] std::span<const glm::vec3> positions() const noexcept { return drawn_; }
  // Vertices that the last update() may have moved, ascending.
  [[nodiscard]] std::span<const VertexId> moved() const noexcept { return moved_; }

 private:
  std::span<const glm::vec3> own_;
  std::vector<glm::vec3> drawn_;
  std::vector<VertexId> under_way_;
  std::vector<VertexId> moved_;
};

}  // namespace occlod
