// Cones of directions, and which polygons turn their back on all of a cell: Chhugani and others 2003, sec. 5.3:
// after Sederberg and Meyers 1988, corrected.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "occlod/cell_builder.h"

namespace occlod::paper {

// All unit vectors that are no farther than `angle` from the axis.
struct Cone {
  glm::dvec3 axis{0.0, 0.0, 1.0};  // unit length
  double angle = 0.0;              // radians, in [0, pi)
};

// A cone around unit vectors (at least one): nearly the smallest. None from 180 degrees on. O(n).
[[nodiscard]] std::optional<Cone> bounding_cone(std::span<const glm::dvec3> vectors);

// What eyes of a cell can see of polygons.
enum class Facing { front, back, mixed };

// Of polygons inside `box` with normals in the cone: all fronts, all backs, or not decided. By cones around the
// directions from the corners of the box to the cell, as the paper does; conservative.
[[nodiscard]] Facing facing(const CellBox& cell, const CellBox& box, const Cone& normals);

}  // namespace occlod::paper
