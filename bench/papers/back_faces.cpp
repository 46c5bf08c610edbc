#include "papers/back_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "cells/cell_geometry.h"
#include "papers/convex_occluder.h"

namespace occlod::paper {
namespace {

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// A cone around one cone and one vector outside it.
std::optional<Cone> with(const Cone& cone, const glm::dvec3& vector) {
  const double to_axis = angle_between(vector, cone.axis);
  if (cone.angle + to_axis >= std::numbers::pi) return std::nullopt;
  // The rim vector on the far side of the axis.
  glm::dvec3 far_rim = cone.axis;
  if (cone.angle > 0.0)
    far_rim = glm::normalize(std::sin(cone.angle + to_axis) / std::sin(cone.angle) * cone.axis - vector);
  const glm::dvec3 axis = glm::normalize(far_rim + vector);
  return Cone{axis, angle_between(axis, vector)};
}

}  // namespace

std::optional<Cone> bounding_cone(std::span<const glm::dvec3> vectors) {
  std::optional<Cone> cone(Cone{vectors.front(), 0.0});
  for (const glm::dvec3& vector : vectors.subspan(1)) {
    if (angle_between(vector, cone->axis) <= cone->angle) continue;
    cone = with(*cone, vector);
    if (!cone) break;
  }
  return cone;
}

Facing facing(const CellBox& cell, const CellBox& box, const Cone& normals) {
  double largest = 0.0, smallest = std::numbers::pi;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 from = corner(box, i);
    std::array<glm::dvec3, 8> directions;
    for (int k = 0; k < 8; ++k) {
      const glm::dvec3 along = corner(cell, k) - from;
      if (along == glm::dvec3(0.0)) return Facing::mixed;
      directions[static_cast<std::size_t>(k)] = glm::normalize(along);
    }
    const std::optional<Cone> visible = bounding_cone(directions);
    if (!visible) return Facing::mixed;
    const double between = angle_between(normals.axis, visible->axis), spread = visible->angle + normals.angle;
    largest = std::max(largest, between + spread);
    smallest = std::min(smallest, between - spread);
  }
  if (overlap(cell, box)) return Facing::mixed;
  if (largest < std::numbers::pi / 2.0) return Facing::front;
  return smallest > std::numbers::pi / 2.0 ? Facing::back : Facing::mixed;
}

}  // namespace occlod::paper
