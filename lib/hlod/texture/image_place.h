// Where vertices are in the image that their node has of its own.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <optional>

#include "occlod/hlod.h"

namespace occlod::hlod {

// Returns where vertex v of a node with an image is in it, in [0, 1], from the top left; nothing where its material is
// shown otherwise. O(1).
[[nodiscard]] inline std::optional<glm::vec2> image_place(const HlodView& view, const NodeMesh& node, std::size_t v) {
  constexpr float end = 65535.0F;
  if (view.image_materials[node.materials.empty() ? MaterialId{0} : node.materials[v]] == 0) return std::nullopt;
  return glm::vec2(node.image_coordinates[v]) / end;
}

}  // namespace occlod::hlod
