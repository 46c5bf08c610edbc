// The convex hull of a cell and a box: all segments from one to the other lie in it.
#pragma once

#include <array>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "occlod/cell_builder.h"

namespace occlod {

// It is the box around both, cut by planes that are each parallel to an axis: a face of the hull that belongs to
// neither box alone holds an edge of one of them. For outward normals without a zero the hull is reached in one corner
// of each box only, and those span no face.
class Hull {
 public:
  Hull(const CellBox& eyes, const CellBox& what);

  // Whether the segment ab may meet the hull grown by `margin` (world units) in each axis. False only when it does not;
  // true only when it does, up to rounding.
  [[nodiscard]] bool may_meet(const glm::dvec3& a, const glm::dvec3& b, double margin) const;

 private:
  // Outside is where by_u * p[u] + by_v * p[v] > reach + growth * margin.
  struct Plane {
    int u = 0, v = 0;  // axes
    double by_u = 0.0, by_v = 0.0, reach = 0.0, growth = 0.0;
  };
  void add_planes(const CellBox& eyes, const CellBox& what, int u, int v);

  CellBox around_;
  std::array<Plane, 12> planes_;  // four for each pair of axes at most
  std::size_t plane_count_ = 0;
};

// Whether the triangle meets the box: the separating axes of Akenine-Moeller 2001. Touching counts.
[[nodiscard]] bool triangle_meets(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const CellBox& box);

// Segments from a cell to a box, and whether they cross triangles.

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
