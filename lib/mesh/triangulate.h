// Cuts polygons into triangles.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// Keeps its scratch memory from polygon to polygon. `positions` outlives it.
class Triangulator {
 public:
  explicit Triangulator(std::span<const glm::vec3> positions) : positions_(positions) {}

  // Appends corners.size() - 2 triangles with the polygon's winding: a fan where it is strictly convex, otherwise ears
  // clipped in the plane of its area vector (Newell). One that crosses itself or lies on a line becomes a fan. At least
  // three corners with finite positions. False, with nothing appended, where clipping takes more than 2^28 steps:
  // 16,384 corners can need that many.
  template <class Triangles>  // a vector or a LargeVector
  [[nodiscard]] bool append(std::span<const VertexId> corners, Triangles& triangles);

 private:
  [[nodiscard]] bool project(std::span<const VertexId> corners);
  [[nodiscard]] bool is_strictly_convex() const;
  enum class Clipping { done, crosses_itself, takes_too_long };
  template <class Triangles>
  [[nodiscard]] Clipping clip_ears(std::span<const VertexId> corners, Triangles& triangles);
  [[nodiscard]] bool is_ear(std::size_t tip, bool allow_flat);
  void unlink(std::size_t corner);
  [[nodiscard]] double turn_at(std::size_t corner) const;

  std::span<const glm::vec3> positions_;
  std::vector<glm::dvec2> points_;  // the polygon in its plane, counter-clockwise
  std::vector<std::size_t> next_;   // the ring of the corners that are left
  std::vector<std::size_t> previous_;
  std::size_t steps_ = 0;  // corners looked at while clipping the current polygon
};

}  // namespace occlod
