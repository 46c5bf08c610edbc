// The convex hull of a cell and a box: all segments from one to the other lie in it.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>

#include "occlod/viewcells/cell_view.h"

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

}  // namespace occlod
