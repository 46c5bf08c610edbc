#include "mesh/triangulate.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/large_vector.h"

namespace occlod {
namespace {

constexpr std::size_t max_steps = std::size_t{1} << 28;

// Twice the signed area of a, b, c: positive for a left turn.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

template <class Triangles>
void append_fan(std::span<const VertexId> corners, Triangles& triangles) {
  for (std::size_t i = 2; i < corners.size(); ++i) triangles.emplace_back(corners[0], corners[i - 1], corners[i]);
}

}  // namespace

template <class Triangles>
bool Triangulator::append(std::span<const VertexId> corners, Triangles& triangles) {
  if (corners.size() == 3 || !project(corners) || is_strictly_convex()) {
    append_fan(corners, triangles);
    return true;
  }
  const std::size_t before = triangles.size();
  const Clipping clipping = clip_ears(corners, triangles);
  if (clipping != Clipping::done) triangles.resize(before);
  if (clipping == Clipping::crosses_itself) append_fan(corners, triangles);
  return clipping != Clipping::takes_too_long;
}

// Drops the coordinate along which the area vector is longest: that keeps orientation and convexity. False for zero
// area.
bool Triangulator::project(std::span<const VertexId> corners) {
  const glm::dvec3 origin(positions_[corners[0]]);
  glm::dvec3 area(0.0);
  for (std::size_t i = 2; i < corners.size(); ++i) {
    area += glm::cross(glm::dvec3(positions_[corners[i - 1]]) - origin, glm::dvec3(positions_[corners[i]]) - origin);
  }
  const glm::dvec3 size = glm::abs(area);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  if (!(size[axis] > 0.0)) return false;
  const int u = (axis + (area[axis] > 0.0 ? 1 : 2)) % 3;
  const int v = 3 - axis - u;
  points_.clear();
  for (const VertexId corner : corners) {
    const glm::dvec3 p = glm::dvec3(positions_[corner]) - origin;
    points_.emplace_back(p[u], p[v]);
  }
  return true;
}

// A star polygon that winds several times also turns left everywhere; it crosses itself, so it may become a fan as
// well.
bool Triangulator::is_strictly_convex() const {
  const std::size_t n = points_.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (!(turn(points_[i], points_[(i + 1) % n], points_[(i + 2) % n]) > 0.0)) return false;
  }
  return true;
}

template <class Triangles>
Triangulator::Clipping Triangulator::clip_ears(std::span<const VertexId> corners, Triangles& triangles) {
  const std::size_t n = corners.size();
  next_.resize(n);
  previous_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    next_[i] = (i + 1) % n;
    previous_[i] = (i + n - 1) % n;
  }
  const auto emit = [&](std::size_t tip) {
    triangles.emplace_back(corners[previous_[tip]], corners[tip], corners[next_[tip]]);
  };
  steps_ = 0;
  std::size_t tip = 0;
  std::size_t refused = 0;  // consecutive corners that are not ears
  for (std::size_t left = n; left > 3;) {
    // Flat ears, whose triangles have no area, only where nothing else is left: corners on a straight edge.
    if (refused == 2 * left) return Clipping::crosses_itself;
    if (steps_ > max_steps) return Clipping::takes_too_long;
    if (!is_ear(tip, refused >= left)) {
      ++refused;
      tip = next_[tip];
      continue;
    }
    emit(tip);
    unlink(tip);
    tip = next_[next_[tip]];  // not the neighbour: that would make a fan of slivers
    --left;
    refused = 0;
  }
  if (turn_at(tip) < 0.0) return Clipping::crosses_itself;
  emit(tip);
  return Clipping::done;
}

void Triangulator::unlink(std::size_t corner) {
  next_[previous_[corner]] = next_[corner];
  previous_[next_[corner]] = previous_[corner];
}

double Triangulator::turn_at(std::size_t corner) const {
  return turn(points_[previous_[corner]], points_[corner], points_[next_[corner]]);
}

// An ear is a corner that turns left and whose triangle holds no other corner. Only corners that do not turn left need
// to be tested: if any corner is inside, one of those is.
bool Triangulator::is_ear(std::size_t tip, bool allow_flat) {
  ++steps_;
  const double area = turn_at(tip);
  if (area == 0.0) return allow_flat;
  if (!(area > 0.0)) return false;
  const glm::dvec2& a = points_[previous_[tip]];
  const glm::dvec2& b = points_[tip];
  const glm::dvec2& c = points_[next_[tip]];
  for (std::size_t i = next_[next_[tip]]; i != previous_[tip]; i = next_[i]) {
    ++steps_;
    const glm::dvec2& p = points_[i];
    if (p == a || p == b || p == c || turn_at(i) > 0.0) continue;
    if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
  }
  return true;
}

template bool Triangulator::append(std::span<const VertexId> corners, std::vector<Triangle>& triangles);
template bool Triangulator::append(std::span<const VertexId> corners, LargeVector<Triangle>& triangles);

}  // namespace occlod
