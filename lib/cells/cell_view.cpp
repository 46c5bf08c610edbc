#include "occlod/viewcells/cell_view.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "occlod/core/error.h"
#include "base/placement.h"
#include "cells/cell_geometry.h"

namespace occlod {
namespace {

// Of sums and products of a few terms in double precision, relative to the largest of them.
constexpr double rounding = 1e-14;

bool finite(const glm::dvec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

void require_cell(const CellBox& cell) {
  if (!finite(cell.min) || !finite(cell.max))
    throw Error({"cell", "", "a corner is not a finite number", "give a box of finite numbers"});
  if (glm::any(glm::greaterThan(cell.min, cell.max)))
    throw Error({"cell", "", "its least corner lies beyond its largest", "give min <= max in every axis"});
}

void require_eyes(const EyeModel& eyes) {
  const auto refuse = [](const char* field, const char* range) {
    throw Error({"eye model", field, "is out of its range", range});
  };
  if (!(eyes.focal_length_px > 0.0) || !std::isfinite(eyes.focal_length_px))
    refuse("focal_length_px", "give a number > 0");
  if (!(eyes.cos_corner_angle > 0.0 && eyes.cos_corner_angle <= 1.0)) refuse("cos_corner_angle", "give one in (0, 1]");
  if (!(eyes.near > 0.0) || !std::isfinite(eyes.near)) refuse("near", "give a distance > 0");
  if (!(eyes.clearance >= 0.0) || !std::isfinite(eyes.clearance)) refuse("clearance", "give a distance >= 0");
}

}  // namespace

EyeModel eye_model(const View& view) {
  if (view.is_orthographic())
    throw Error({"camera", "orthographic_height", "an orthographic view has no eye that could be in a cell",
                 "give a camera in perspective"});
  return {view.focal_length_px(), view.cos_corner_angle(), view.camera().near, 0.0};
}

CellView::CellView(const CellBox& cell, const EyeModel& eyes, const glm::dmat4& object_to_world)
    : cell_(cell), eyes_(eyes), object_to_world_(object_to_world) {
  require_cell(cell);
  require_eyes(eyes);
  require_placement(object_to_world);
  const glm::dmat3 linear(object_to_world);
  largest_stretch_ = stretch_of(linear);
  scale_at_near_px_ = eyes.focal_length_px * largest_stretch_ / (eyes.near * eyes.cos_corner_angle);
  const double reach =
      occlod::largest_coordinate(cell) + occlod::largest_coordinate(CellBox{object_to_world_[3], object_to_world_[3]});
  double steps = 0.0;  // object units per world unit, at most
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0.0);
    step[axis] = 1.0;
    steps += glm::length(solve(linear, step));
  }
  corner_slack_ = rounding * steps * reach;
  for (std::size_t i = 0; i < 8; ++i) {
    const glm::dvec3 corner((i & 1U) != 0 ? cell.max.x : cell.min.x, (i & 2U) != 0 ? cell.max.y : cell.min.y,
                            (i & 4U) != 0 ? cell.max.z : cell.min.z);
    corners_[i] = solve(linear, corner - object_to_world_[3]);
    rounded_corners_[i] = glm::vec3(corners_[i]);
  }
}

// A displacement at distance d and angle a from the axis covers at most f / (d cos^2 a) pixels per unit; and, as the
// depth z = d cos a is no less than that of the near plane, at most f / (z cos a) with z = near. The largest angle is
// that of the corners of the image.
double CellView::scale_px_at(double distance) const noexcept {
  const double cos_angle = eyes_.cos_corner_angle, nearest = std::max(distance, eyes_.clearance);
  if (!(nearest > 0.0)) return scale_at_near_px_;
  return std::min(scale_at_near_px_, eyes_.focal_length_px * largest_stretch_ / (nearest * cos_angle * cos_angle));
}

float CellView::largest_scale_px(const Sphere& sphere) const noexcept {
  const glm::dvec3 center = object_to_world_ * glm::dvec4(sphere.center, 1.0);
  return rounded_up(
      scale_px_at(smallest_distance(cell_, {center, center}) - static_cast<double>(sphere.radius) * largest_stretch_));
}

float CellView::largest_scale_px(const Box& box) const noexcept {
  return rounded_up(scale_px_at(smallest_distance(cell_, world_box(box, 0.0))));
}

double CellView::smallest_scale_px(const Box& box) const noexcept {
  return scale_px_at(largest_distance(cell_, world_box(box, 0.0)));
}

bool CellView::faces_away(const NormalCone& cone, const Sphere& sphere) const noexcept {
  if (!cone.culls()) return false;
  return std::all_of(rounded_corners_.begin(), rounded_corners_.end(),
                     [&](const glm::vec3& eye) { return occlod::faces_away(cone, sphere, eye); });
}

bool CellView::faces_away(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) const noexcept {
  const glm::dvec3 from(a), u = glm::dvec3(b) - from, v = glm::dvec3(c) - from, normal = glm::cross(u, v);
  const double size = glm::length(u) * glm::length(v), length = glm::length(normal);
  return std::all_of(corners_.begin(), corners_.end(), [&](const glm::dvec3& eye) {
    const glm::dvec3 to_eye = eye - from;
    const double slack = rounding * size * glm::length(to_eye) + length * corner_slack_;
    return glm::dot(normal, to_eye) < -slack;
  });
}

CellBox CellView::world_box(const Box& box, double margin) const noexcept {
  const glm::dvec3 middle = 0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max));
  const glm::dvec3 half = 0.5 * (glm::dvec3(box.max) - glm::dvec3(box.min)) + margin;
  const glm::dvec3 center = object_to_world_ * glm::dvec4(middle, 1.0);
  glm::dvec3 reach(0.0), size = glm::abs(object_to_world_[3]);
  for (int axis = 0; axis < 3; ++axis) {
    reach += glm::abs(object_to_world_[axis]) * half[axis];
    size += glm::abs(object_to_world_[axis] * middle[axis]);
  }
  const glm::dvec3 outwards = reach * (1.0 + rounding) + rounding * size;
  return {center - outwards, center + outwards};
}

}  // namespace occlod
