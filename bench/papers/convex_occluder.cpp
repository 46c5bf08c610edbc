#include "papers/convex_occluder.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>

#include "cells/cell_geometry.h"

namespace occlod::paper {
namespace {

constexpr double rounding = 1e-9;  // of the size of occluder and cell

double size_of(const ConvexOccluder& occluder, const CellBox& cell) {
  CellBox around = cell;
  for (const glm::dvec3& p : occluder.corners) around = unite(around, {p, p});
  return glm::length(around.max - around.min);
}

double farthest(const HalfSpace& space, const ConvexOccluder& occluder) {
  double most = -std::numeric_limits<double>::infinity();
  for (const glm::dvec3& p : occluder.corners) most = std::max(most, space.distance(p));
  return most;
}

double farthest(const HalfSpace& space, const CellBox& box) {
  double most = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 8; ++i) most = std::max(most, space.distance(corner(box, i)));
  return most;
}

// The occluder is on the inner side of none of its faces with any of the cell in front of it only if both are apart.
bool are_apart(const ConvexOccluder& occluder, const CellBox& cell, double slack) {
  for (const HalfSpace& face : occluder.faces) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 8; ++i) least = std::min(least, face.distance(corner(cell, i)));
    if (least > slack) return true;
  }
  CellBox around{occluder.corners[0], occluder.corners[0]};
  for (const glm::dvec3& p : occluder.corners) around = unite(around, {p, p});
  return !overlap(around, cell);
}

}  // namespace

glm::dvec3 corner(const CellBox& box, int i) {
  return {(i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
          (i & 4) != 0 ? box.max.z : box.min.z};
}

ConvexOccluder box_occluder(const CellBox& box) {
  ConvexOccluder occluder;
  for (int i = 0; i < 8; ++i) {
    occluder.corners.push_back(corner(box, i));
    for (const int axis : {1, 2, 4})
      if ((i & axis) == 0) occluder.edges.push_back({corner(box, i), corner(box, i | axis)});
  }
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 normal(0.0);
    normal[axis] = 1.0;
    occluder.faces.push_back({normal, box.max[axis]});
    occluder.faces.push_back({-normal, -box.min[axis]});
  }
  return occluder;
}

ConvexOccluder polygon_occluder(std::vector<glm::dvec3> corners) {
  ConvexOccluder occluder;
  for (std::size_t i = 0; i < corners.size(); ++i)
    occluder.edges.push_back({corners[i], corners[(i + 1) % corners.size()]});
  const glm::dvec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  const double offset = glm::dot(normal, corners[0]);
  occluder.faces = {{normal, offset}, {-normal, -offset}};
  occluder.corners = std::move(corners);
  return occluder;
}

std::optional<HalfSpace> horizon_plane(const std::array<glm::dvec3, 2>& edge, const ConvexOccluder& occluder,
                                       const CellBox& cell) {
  const double slack = rounding * size_of(occluder, cell);
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 across = glm::cross(edge[1] - edge[0], corner(cell, i) - edge[0]);
    const double length = glm::length(across);
    if (length <= slack * slack) continue;
    for (const double side : {1.0, -1.0}) {
      const glm::dvec3 normal = side / length * across;
      const HalfSpace space{normal, glm::dot(normal, edge[0])};
      if (farthest(space, occluder) <= slack && farthest(space, cell) <= slack) return space;
    }
  }
  return std::nullopt;
}

std::optional<ShadowFrustum> shadow_frustum(const ConvexOccluder& occluder, const CellBox& cell) {
  const double slack = rounding * size_of(occluder, cell);
  if (!are_apart(occluder, cell, slack)) return std::nullopt;
  ShadowFrustum frustum;
  for (const HalfSpace& face : occluder.faces)
    if (farthest(face, cell) > slack) frustum.behind.push_back(face);
  for (const std::array<glm::dvec3, 2>& edge : occluder.edges)
    if (const std::optional<HalfSpace> plane = horizon_plane(edge, occluder, cell)) frustum.horizon.push_back(*plane);
  if (frustum.behind.empty() || frustum.horizon.empty()) return std::nullopt;
  return frustum;
}

bool holds(const ShadowFrustum& frustum, const CellBox& box) {
  const auto is_inside = [&](const HalfSpace& space) { return farthest(space, box) <= 0.0; };
  return std::all_of(frustum.horizon.begin(), frustum.horizon.end(), is_inside) &&
         std::all_of(frustum.behind.begin(), frustum.behind.end(), is_inside);
}

}  // namespace occlod::paper
