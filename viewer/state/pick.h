// Finds the triangle at a place in the picture.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <optional>

#include "clipping.h"
#include "navigation.h"
#include "refine_worker.h"

namespace occlod::viewer {

struct Hit {
  std::size_t object = 0;  // of the frame's job
  std::size_t triangle = 0;
  glm::dvec3 point{0.0};  // world space
  double distance = 0.0;  // in lengths of the ray's direction
};

// Returns the nearest triangle of the frame's first side that a ray meets from either side, where it is not clipped.
// O(triangles).
[[nodiscard]] std::optional<Hit> cast_ray(const RefinedFrame& frame, const Ray& ray, const ClipPlane& clip = {});

// Names a picked triangle, and the split that made it or the node that it belongs to.
struct Pick {
  std::uint64_t object = 0;   // id
  SplitId split = no_id;      // no_id: a triangle of the base mesh, or of an HLOD
  hlod::NodeId node = no_id;  // of an HLOD
  Triangle triangle{0, 0, 0};
  std::array<glm::dvec3, 3> corners{};  // of the triangle, object space
  glm::dvec3 point{0.0};                // world space
};
[[nodiscard]] Pick pick_of(const RefinedFrame& frame, const Hit& hit);

}  // namespace occlod::viewer
