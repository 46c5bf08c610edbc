// Vertices on their way from their parents to their own places.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/refine/refiner.h"

namespace occlod {

// The positions of a mesh's vertices as they are drawn while some of them slide.
class MorphedPositions {
 public:
  explicit MorphedPositions(std::span<const glm::vec3> positions);  // outlive this; copied

  // The geomorphs of one call of Refiner::update(), which replace those of the call before. O(n log n) for n of both.
  void update(std::span<const Geomorph> geomorphs);

  [[nodiscard]] std::span<const glm::vec3> positions() const noexcept { return drawn_; }
  // Those that the last update() may have moved, ascending.
  [[nodiscard]] std::span<const VertexId> moved() const noexcept { return moved_; }

 private:
  std::span<const glm::vec3> own_;
  std::vector<glm::vec3> drawn_;
  std::vector<VertexId> under_way_;
  std::vector<VertexId> moved_;
};

}  // namespace occlod
