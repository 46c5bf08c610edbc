// What a convex occluder hides from all of a cell: horizon planes and shadow frusta (Chhugani and others 2003, sec. 5).
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "occlod/cell_builder.h"

namespace occlod::paper {

// All x with dot(normal, x) <= offset.
struct HalfSpace {
  glm::dvec3 normal{0.0};  // unit length
  double offset = 0.0;
  [[nodiscard]] double distance(const glm::dvec3& p) const noexcept {
    return normal.x * p.x + normal.y * p.y + normal.z * p.z - offset;
  }
};

// A convex solid or a convex planar polygon.
struct ConvexOccluder {
  std::vector<glm::dvec3> corners;
  std::vector<std::array<glm::dvec3, 2>> edges;
  std::vector<HalfSpace> faces;  // that bound the solid; of a polygon its plane, either way round
};
[[nodiscard]] ConvexOccluder box_occluder(const CellBox& box);
// At least three corners in one plane, in order.
[[nodiscard]] ConvexOccluder polygon_occluder(std::vector<glm::dvec3> corners);

// A corner of a box, as corner(Box, i).
[[nodiscard]] glm::dvec3 corner(const CellBox& box, int i);

// The plane through an edge of an occluder and one corner of the cell that holds occluder and cell on one side; none if
// none does.
[[nodiscard]] std::optional<HalfSpace> horizon_plane(const std::array<glm::dvec3, 2>& edge,
                                                     const ConvexOccluder& occluder, const CellBox& cell);

// What a convex occluder hides from all of a cell: all that is on the inner side of all horizon planes, and behind all
// faces that some of the cell is in front of.
//
// It is all: from one eye v the occluder hides what is behind the faces that v is in front of and inside the planes
// through v and the edges between a face F that faces v and a face G that does not. Turn such a plane outwards around
// its edge to the last corner w of the cell. If w is not in front of G either, that is the horizon plane of the edge,
// and beyond the edge it leaves less inside than the plane through v. If it is, then what is outside of the plane
// through v is in front of G.
struct ShadowFrustum {
  std::vector<HalfSpace> horizon;
  std::vector<HalfSpace> behind;
};
// None where occluder and cell meet, or the cell is in front of no face. O(edges * corners).
[[nodiscard]] std::optional<ShadowFrustum> shadow_frustum(const ConvexOccluder& occluder, const CellBox& cell);

// Whether all of the box is inside: the occluder hides it from all of the cell.
[[nodiscard]] bool holds(const ShadowFrustum& frustum, const CellBox& box);

}  // namespace occlod::paper
