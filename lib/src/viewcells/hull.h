// The convex hull of a cell and a box: all segments from one to the other lie in it.
#pragma once

#include <glm/vec3.hpp>

#include "occlod/viewcells/cell_view.h"

namespace occlod {

// It is the union over t in [0, 1] of the boxes (1 - t) eyes + t what.
class Hull {
 public:
  Hull(const CellBox& eyes, const CellBox& what);

  // Whether the segment ab may meet the hull grown by `margin` (world units) in each axis. False only when it does not.
  [[nodiscard]] bool may_meet(const glm::dvec3& a, const glm::dvec3& b, double margin) const;

 private:
  CellBox eyes_, what_, around_;
};

// Whether the triangle meets the box: the separating axes of Akenine-Moeller 2001. Touching counts.
[[nodiscard]] bool triangle_meets(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const CellBox& box);

}  // namespace occlod
