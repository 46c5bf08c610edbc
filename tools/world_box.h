// Where all objects of a scene are.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "occlod/scene.h"

namespace occlod::tool {

// Along the axes of world space.
struct WorldBox {
  glm::dvec3 low;
  glm::dvec3 high;

  [[nodiscard]] glm::dvec3 center() const { return (low + high) / 2.0; }
  [[nodiscard]] double radius() const;  // of the sphere around it
};

// Hold the boxes of all objects, of which there is at least one.
[[nodiscard]] WorldBox world_box(std::span<const LoadedObject> objects);
[[nodiscard]] WorldBox world_box(std::span<const LoadedHlod> hlods);

}  // namespace occlod::tool
