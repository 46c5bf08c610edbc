// Computes simple geometric properties of cells as boxes.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "base/arithmetic.h"
#include "occlod/cell_builder.h"
#include "occlod/hierarchy.h"
#include "splits/star.h"

namespace occlod {

[[nodiscard]] inline CellBox grown(const CellBox& box, double margin) { return {box.min - margin, box.max + margin}; }

[[nodiscard]] inline CellBox unite(const CellBox& a, const CellBox& b) {
  return {glm::min(a.min, b.min), glm::max(a.max, b.max)};
}

[[nodiscard]] inline bool overlap(const CellBox& a, const CellBox& b) {
  return a.min.x <= b.max.x && a.max.x >= b.min.x && a.min.y <= b.max.y && a.max.y >= b.min.y && a.min.z <= b.max.z &&
         a.max.z >= b.min.z;
}

// Returns the smallest and the largest distance between a point of one box and a point of the other.
[[nodiscard]] inline double smallest_distance(const CellBox& a, const CellBox& b) {
  return glm::length(glm::max(glm::max(a.min - b.max, b.min - a.max), glm::dvec3(0.0)));
}
[[nodiscard]] inline double largest_distance(const CellBox& a, const CellBox& b) {
  return glm::length(glm::max(glm::abs(a.max - b.min), glm::abs(b.max - a.min)));
}

[[nodiscard]] inline double largest_coordinate(const CellBox& box) {
  const glm::dvec3 m = glm::max(glm::abs(box.min), glm::abs(box.max));
  return std::max({m.x, m.y, m.z});
}

[[nodiscard]] inline int longest_axis(const CellBox& box) {
  const glm::dvec3 size = box.max - box.min;
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

// Bounds the faces that a split changes by a box.

// Returns a box around the faces that the split inserts, object space.
[[nodiscard]] inline Box box_of(const SplitStar& star, std::span<const glm::vec3> positions) {
  Box box{positions[star.vertex()], positions[star.vertex()]};
  star.for_each_face([&](const Triangle& t) {
    for (int k = 0; k < 3; ++k) box = unite(box, {positions[t[k]], positions[t[k]]});
  });
  return box;
}

}  // namespace occlod
