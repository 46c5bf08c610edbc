// Segments from a cell to a box, and whether they cross triangles.
#pragma once

#include <array>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "occlod/viewcells/cell_view.h"

namespace occlod {

struct CellSegment {
  glm::dvec3 from{0.0}, to{0.0};
};

// Where segments begin in the cell and end in the box: shares of both. The next is tried where one comes too close to
// an edge to tell on which side it passes.
inline constexpr std::size_t inner_segments = 8;
// From the corners of the cell to those of the box that lie in the same place: they bound the hull of both.
inline constexpr std::size_t outer_segments = 8;

// i: below inner_segments + outer_segments, inner ones first.
[[nodiscard]] CellSegment segment_between(const CellBox& cell, const CellBox& what, std::size_t i);

// Whether the segment meets the triangle; nothing where rounding decides.
[[nodiscard]] std::optional<bool> crosses(const CellSegment& segment, const glm::dvec3& a, const glm::dvec3& b,
                                          const glm::dvec3& c);

[[nodiscard]] inline glm::dvec3 corner_of(const CellBox& box, std::size_t k) {
  return {(k & 1U) != 0 ? box.max.x : box.min.x, (k & 2U) != 0 ? box.max.y : box.min.y,
          (k & 4U) != 0 ? box.max.z : box.min.z};
}

}  // namespace occlod
