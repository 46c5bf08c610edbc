// Computes the box of all objects of a scene.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "occlod/scene.h"

namespace occlod::tool {

// Is aligned with the axes of world space.
struct WorldBox {
  glm::dvec3 low;
  glm::dvec3 high;

  [[nodiscard]] glm::dvec3 center() const { return (low + high) / 2.0; }
  [[nodiscard]] double radius() const;  // of the sphere around it
};

// These need at least one object.
[[nodiscard]] WorldBox world_box(std::span<const LoadedObject> objects);
[[nodiscard]] WorldBox world_box(std::span<const LoadedHlod> hlods);

}  // namespace occlod::tool
