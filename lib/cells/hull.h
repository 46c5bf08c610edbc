// Represents the convex hull of a cell and a box: all segments from one to the other lie in it.
#pragma once

#include <array>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "occlod/cell_builder.h"

namespace occlod {

// The hull is the box around both, clipped by planes that are each parallel to an axis: a face of the hull that belongs
// to neither box alone contains an edge of one of them. For outward normals without a zero component the hull is
// reached in only one corner of each box, and two corners span no face.
class Hull {
 public:
  Hull(const CellBox& eyes, const CellBox& what);

  // Returns whether the segment ab may meet the hull grown by `margin` (world units) in each axis. False only when it
  // does not; true only when it does, up to rounding.
  [[nodiscard]] bool may_meet(const glm::dvec3& a, const glm::dvec3& b, double margin) const;

 private:
  // The outside is where by_u * p[u] + by_v * p[v] > reach + growth * margin.
  struct Plane {
    int u = 0, v = 0;  // axes
    double by_u = 0.0, by_v = 0.0, reach = 0.0, growth = 0.0;
  };
  void add_planes(const CellBox& eyes, const CellBox& what, int u, int v);

  CellBox around_;
  std::array<Plane, 12> planes_;  // at most four for each pair of axes
  std::size_t plane_count_ = 0;
};

// Returns whether the triangle meets the box, by the separating axes of Akenine-Moeller 2001. Touching counts.
[[nodiscard]] bool triangle_meets(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const CellBox& box);

// Chooses segments from a cell to a box and tests whether they cross triangles.

struct CellSegment {
  glm::dvec3 from{0.0}, to{0.0};
};

// Number of inner segments, whose ends are given as fractions of the cell and of the box. The next one is tried where
// one comes too close to an edge to tell on which side it passes.
inline constexpr std::size_t inner_segments = 8;
// Number of segments from the corners of the cell to the corresponding corners of the box: they bound the hull of both.
inline constexpr std::size_t outer_segments = 8;

// Returns segment i, with i below inner_segments + outer_segments; inner segments come first.
[[nodiscard]] CellSegment segment_between(const CellBox& cell, const CellBox& what, std::size_t i);

// Returns whether the segment meets the triangle; nothing where rounding decides.
[[nodiscard]] std::optional<bool> crosses(const CellSegment& segment, const glm::dvec3& a, const glm::dvec3& b,
                                          const glm::dvec3& c);

[[nodiscard]] inline glm::dvec3 corner_of(const CellBox& box, std::size_t k) {
  return {(k & 1U) != 0 ? box.max.x : box.min.x, (k & 2U) != 0 ? box.max.y : box.min.y,
          (k & 4U) != 0 ? box.max.z : box.min.z};
}

}  // namespace occlod
