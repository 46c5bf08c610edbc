// Ear clipping; Eberly, "Triangulation by Ear Clipping", 2002. A grid finds the corners near an ear. Why no library:
// docs/internals/decisions.md#2-own-mesh-readers.
#include "mesh/triangulate.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/memory.h"

namespace occlod {
namespace {

constexpr std::size_t fewest_for_grid = 64;  // corners

// Returns twice the signed area of a, b, c, which is positive for a left turn.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

template <class Triangles>
void append_fan(std::span<const VertexId> corners, Triangles& triangles) {
  for (std::size_t i = 2; i < corners.size(); ++i) triangles.emplace_back(corners[0], corners[i - 1], corners[i]);
}

}  // namespace

void Triangulator::Grid::build(std::span<const glm::dvec2> points, std::span<const std::uint32_t> next,
                               std::uint32_t first, std::size_t count) {
  glm::dvec2 high(-std::numeric_limits<double>::infinity());
  low_ = -high;
  const auto for_each_corner = [&](const auto& what) {
    std::uint32_t corner = first;
    for (std::size_t i = 0; i < count; ++i, corner = next[corner]) what(corner);
  };
  for_each_corner([&](std::uint32_t corner) {
    low_ = glm::min(low_, points[corner]);
    high = glm::max(high, points[corner]);
  });
  side_ = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(count))));
  for (int k = 0; k < 2; ++k) cells_per_unit_[k] = high[k] > low_[k] ? side_ / (high[k] - low_[k]) : 0.0;
  first_.assign(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), no_id);
  next_.resize(points.size());
  for_each_corner([&](std::uint32_t corner) {
    std::uint32_t& head = first_[index_of(cell_of(points[corner]))];
    next_[corner] = head;
    head = corner;
  });
}

// Rounds like itself for corners and for boxes: a point in a box lies in one of the cells of the box.
glm::ivec2 Triangulator::Grid::cell_of(const glm::dvec2& at) const {
  return glm::min(glm::ivec2((at - low_) * cells_per_unit_), glm::ivec2(side_ - 1));
}

template <class Test>
std::uint32_t Triangulator::Grid::find(const glm::dvec2& low, const glm::dvec2& high, std::size_t& steps,
                                       const Test& test) const {
  const glm::ivec2 begin = cell_of(low), end = cell_of(high);
  for (int y = begin.y; y <= end.y; ++y) {
    for (int x = begin.x; x <= end.x; ++x) {
      ++steps;
      for (std::uint32_t corner = first_[index_of({x, y})]; corner != no_id; corner = next_[corner]) {
        ++steps;
        if (test(corner)) return corner;
      }
    }
  }
  return no_id;
}

void Triangulator::Grid::remove(std::uint32_t corner, const glm::dvec2& at) {
  std::uint32_t* link = &first_[index_of(cell_of(at))];
  while (*link != corner) link = &next_[*link];
  *link = next_[corner];
}

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

// Drops the coordinate along which the area vector is longest, which keeps orientation and convexity. Returns false for
// zero area.
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

// A star polygon that winds around several times also turns left everywhere; it crosses itself, so it may become a fan
// as well.
bool Triangulator::is_strictly_convex() const {
  const std::size_t n = points_.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (!(turn(points_[i], points_[(i + 1) % n], points_[(i + 2) % n]) > 0.0)) return false;
  }
  return true;
}

template <class Triangles>
Triangulator::Clipping Triangulator::clip_ears(std::span<const VertexId> corners, Triangles& triangles) {
  if (corners.size() >= no_id) return Clipping::takes_too_long;
  const auto n = static_cast<std::uint32_t>(corners.size());
  next_.resize(n);
  previous_.resize(n);
  blockers_.assign(n, no_id);
  for (std::uint32_t i = 0; i < n; ++i) {
    next_[i] = i + 1 == n ? 0 : i + 1;
    previous_[i] = i == 0 ? n - 1 : i - 1;
  }
  const auto emit = [&](std::uint32_t tip) {
    triangles.emplace_back(corners[previous_[tip]], corners[tip], corners[next_[tip]]);
  };
  steps_ = 0;
  std::uint32_t tip = 0;
  std::size_t refused = 0;        // consecutive corners that are not ears
  std::size_t left_for_grid = n;  // number of corners at which the grid is made again, so that its cells grow
  for (std::size_t left = n; left > 3;) {
    if (left <= left_for_grid) {
      uses_grid_ = left >= fewest_for_grid;
      if (uses_grid_) grid_.build(points_, next_, tip, left);
      left_for_grid = left / 2;
    }
    // Flat ears, whose triangles have no area, are cut only when no other ear is left; they are corners on a straight
    // edge.
    if (refused == 2 * left) return Clipping::crosses_itself;
    if (steps_ > max_steps_) return Clipping::takes_too_long;
    if (!is_ear(tip, refused >= left)) {
      ++refused;
      tip = next_[tip];
      continue;
    }
    emit(tip);
    unlink(tip);
    tip = next_[next_[tip]];  // not the neighbour, which would make a fan of slivers
    --left;
    refused = 0;
  }
  if (turn_at(tip) < 0.0) return Clipping::crosses_itself;
  emit(tip);
  return Clipping::done;
}

void Triangulator::unlink(std::uint32_t corner) {
  if (uses_grid_) grid_.remove(corner, points_[corner]);
  next_[previous_[corner]] = next_[corner];
  previous_[next_[corner]] = previous_[corner];
  previous_[corner] = corner;  // marks it as removed
}

double Triangulator::turn_at(std::uint32_t corner) const {
  return turn(points_[previous_[corner]], points_[corner], points_[next_[corner]]);
}

// True for an ear, a corner that turns left and whose triangle contains no other corner. Only corners that do not turn
// left need to be tested: if any corner is inside, one of those is.
bool Triangulator::is_ear(std::uint32_t tip, bool allow_flat) {
  ++steps_;
  const double area = turn_at(tip);
  if (area == 0.0) return allow_flat;
  if (!(area > 0.0)) return false;
  const glm::dvec2& a = points_[previous_[tip]];
  const glm::dvec2& b = points_[tip];
  const glm::dvec2& c = points_[next_[tip]];
  const auto is_inside = [&](std::uint32_t corner) {
    const glm::dvec2& p = points_[corner];
    if (p == a || p == b || p == c || turn_at(corner) > 0.0) return false;
    return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
  };
  std::uint32_t& blocker = blockers_[tip];
  const bool is_removed = blocker == no_id || previous_[blocker] == blocker;
  if (!is_removed && is_inside(blocker)) return false;
  blocker = no_id;
  if (uses_grid_) {
    blocker = grid_.find(glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c)), steps_, is_inside);
  } else {
    for (std::uint32_t i = next_[next_[tip]]; i != previous_[tip] && blocker == no_id; i = next_[i]) {
      ++steps_;
      if (is_inside(i)) blocker = i;
    }
  }
  return blocker == no_id;
}

template bool Triangulator::append(std::span<const VertexId> corners, std::vector<Triangle>& triangles);
template bool Triangulator::append(std::span<const VertexId> corners, LargeVector<Triangle>& triangles);

}  // namespace occlod
