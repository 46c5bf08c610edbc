#include "cells/hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "cells/cell_geometry.h"

namespace occlod {
namespace {

// Holds the remaining part of a segment, from 0 at its start to 1 at its end.
struct Part {
  double first = 0.0, last = 1.0;

  // Clips where a linear function from `at_start` to `at_end` is above 0. Returns false when nothing is left.
  bool cut(double at_start, double at_end) {
    if (at_start <= 0.0 && at_end <= 0.0) return true;
    if (at_start > 0.0 && at_end > 0.0) return false;
    const double crossing = at_start / (at_start - at_end);
    if (at_start > 0.0)
      first = std::max(first, crossing);
    else
      last = std::min(last, crossing);
    return first <= last;
  }
};

// Returns whether [low, high], the projection of the corners onto an axis, is disjoint from the box's projection.
bool apart(const glm::dvec3& axis, const std::array<glm::dvec3, 3>& corners, const glm::dvec3& half) {
  const double p = glm::dot(axis, corners[0]), q = glm::dot(axis, corners[1]), r = glm::dot(axis, corners[2]);
  const double reach = glm::dot(glm::abs(axis), half);
  return std::min({p, q, r}) > reach || std::max({p, q, r}) < -reach;
}

}  // namespace

Hull::Hull(const CellBox& eyes, const CellBox& what) : around_(unite(eyes, what)) {
  for (int axis = 0; axis < 3; ++axis) add_planes(eyes, what, axis, (axis + 1) % 3);
}

// Adds the planes of two rectangles: the hull has an edge between their corners of one side iff neither corner lies
// beyond the other in both axes.
void Hull::add_planes(const CellBox& eyes, const CellBox& what, int u, int v) {
  for (const double sign_u : {-1.0, 1.0})
    for (const double sign_v : {-1.0, 1.0}) {
      const auto corner = [&](const CellBox& box) {
        return glm::dvec2(sign_u < 0.0 ? box.min[u] : box.max[u], sign_v < 0.0 ? box.min[v] : box.max[v]);
      };
      const glm::dvec2 p = corner(eyes), along = corner(what) - p;
      if (!(sign_u * along.x * sign_v * along.y < 0.0)) continue;
      const glm::dvec2 outwards(sign_u * std::abs(along.y), sign_v * std::abs(along.x));
      planes_[plane_count_++] = {
          u, v, outwards.x, outwards.y, glm::dot(outwards, p), std::abs(along.x) + std::abs(along.y)};
    }
}

bool Hull::may_meet(const glm::dvec3& a, const glm::dvec3& b, double margin) const {
  Part left;
  bool has_a = true, has_b = true;
  // Clips only where both ends are outside, which is seldom so: divisions are slow.
  const auto is_beyond = [&](double at_a, double at_b) {
    has_a = has_a && at_a <= 0.0;
    has_b = has_b && at_b <= 0.0;
    return at_a > 0.0 && at_b > 0.0;
  };
  const auto any_plane = [&](const auto& test) {
    for (int axis = 0; axis < 3; ++axis) {
      const double high = around_.max[axis] + margin, low = around_.min[axis] - margin;
      if (test(a[axis] - high, b[axis] - high) || test(low - a[axis], low - b[axis])) return true;
    }
    for (std::size_t i = 0; i < plane_count_; ++i) {
      const Plane& plane = planes_[i];
      const double reach = plane.reach + plane.growth * margin;
      if (test(plane.by_u * a[plane.u] + plane.by_v * a[plane.v] - reach,
               plane.by_u * b[plane.u] + plane.by_v * b[plane.v] - reach))
        return true;
    }
    return false;
  };
  if (any_plane(is_beyond)) return false;
  return has_a || has_b || !any_plane([&](double at_a, double at_b) { return !left.cut(at_a, at_b); });
}

bool triangle_meets(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const CellBox& box) {
  if (!overlap({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))}, box)) return false;
  const glm::dvec3 middle = 0.5 * (box.min + box.max), half = 0.5 * (box.max - box.min);
  const std::array<glm::dvec3, 3> corners = {a - middle, b - middle, c - middle};
  if (apart(glm::cross(b - a, c - a), corners, half)) return false;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 side =
        corners[static_cast<std::size_t>(k == 2 ? 0 : k + 1)] - corners[static_cast<std::size_t>(k)];
    for (const glm::dvec3& axis :
         {glm::dvec3(0, -side.z, side.y), glm::dvec3(side.z, 0, -side.x), glm::dvec3(-side.y, side.x, 0)})
      if (apart(axis, corners, half)) return false;
  }
  return true;
}

namespace {

// Relative rounding error of volumes spanned by differences of coordinates.
constexpr double volume_rounding = 1e-12;

constexpr std::array<std::array<double, 6>, inner_segments> shares = {{{0.5, 0.5, 0.5, 0.5, 0.5, 0.5},
                                                                       {0.37, 0.61, 0.43, 0.58, 0.41, 0.55},
                                                                       {0.71, 0.29, 0.64, 0.33, 0.69, 0.38},
                                                                       {0.23, 0.47, 0.81, 0.76, 0.24, 0.66},
                                                                       {0.86, 0.83, 0.19, 0.11, 0.87, 0.14},
                                                                       {0.13, 0.17, 0.27, 0.91, 0.79, 0.93},
                                                                       {0.54, 0.93, 0.72, 0.27, 0.09, 0.47},
                                                                       {0.94, 0.07, 0.57, 0.46, 0.51, 0.81}}};

// Returns 1, -1, or 0 where rounding decides.
int sign_of(double volume, double size) {
  return std::abs(volume) <= volume_rounding * size ? 0 : volume > 0.0 ? 1 : -1;
}

// Returns the sign of x.cross(y, z), or 0 where rounding decides.
int turn_of(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z) {
  const double volume = glm::dot(x, glm::cross(y, z));
  // Compares squares to avoid a square root.
  if (volume * volume <= volume_rounding * volume_rounding * glm::dot(x, x) * glm::dot(y, y) * glm::dot(z, z)) return 0;
  return volume > 0.0 ? 1 : -1;
}

// Tests, like crosses(), the segment from the origin to d.
std::optional<bool> crosses_from_origin(const glm::dvec3& d, const glm::dvec3& a, const glm::dvec3& b,
                                        const glm::dvec3& c) {
  const int ab = turn_of(d, a, b), bc = turn_of(d, b, c);
  if (ab * bc < 0) return false;
  const int ca = turn_of(d, c, a);
  if (ab * ca < 0 || bc * ca < 0) return false;
  if (ab == 0 || bc == 0 || ca == 0) return std::nullopt;
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double size = glm::length(b - a) * glm::length(c - a), to_a = glm::length(a);
  const int start = sign_of(-glm::dot(normal, a), size * to_a),
            end = sign_of(glm::dot(normal, d - a), size * (to_a + glm::length(d)));
  if (start == 0 || end == 0) return std::nullopt;
  return start != end;
}

}  // namespace

CellSegment segment_between(const CellBox& cell, const CellBox& what, std::size_t i) {
  if (i >= inner_segments) return {corner_of(cell, i - inner_segments), corner_of(what, i - inner_segments)};
  const auto& s = shares[i];
  return {glm::mix(cell.min, cell.max, glm::dvec3(s[0], s[1], s[2])),
          glm::mix(what.min, what.max, glm::dvec3(s[3], s[4], s[5]))};
}

std::optional<bool> crosses(const CellSegment& segment, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return crosses_from_origin(segment.to - segment.from, a - segment.from, b - segment.from, c - segment.from);
}

}  // namespace occlod
