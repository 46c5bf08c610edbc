#include "cells/cell_segment.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace occlod {
namespace {

// Of volumes spanned by differences of coordinates.
constexpr double volume_rounding = 1e-12;

constexpr std::array<std::array<double, 6>, inner_segments> shares = {{{0.5, 0.5, 0.5, 0.5, 0.5, 0.5},
                                                                       {0.37, 0.61, 0.43, 0.58, 0.41, 0.55},
                                                                       {0.71, 0.29, 0.64, 0.33, 0.69, 0.38},
                                                                       {0.23, 0.47, 0.81, 0.76, 0.24, 0.66},
                                                                       {0.86, 0.83, 0.19, 0.11, 0.87, 0.14},
                                                                       {0.13, 0.17, 0.27, 0.91, 0.79, 0.93},
                                                                       {0.54, 0.93, 0.72, 0.27, 0.09, 0.47},
                                                                       {0.94, 0.07, 0.57, 0.46, 0.51, 0.81}}};

// 1, -1, or 0 where rounding decides.
int sign_of(double volume, double size) {
  return std::abs(volume) <= volume_rounding * size ? 0 : volume > 0.0 ? 1 : -1;
}

// The sign of x.cross(y, z), or 0 where rounding decides.
int turn_of(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z) {
  const double volume = glm::dot(x, glm::cross(y, z));
  // Squares, so that no root is taken.
  if (volume * volume <= volume_rounding * volume_rounding * glm::dot(x, x) * glm::dot(y, y) * glm::dot(z, z)) return 0;
  return volume > 0.0 ? 1 : -1;
}

// As crosses(), of the segment from the origin to d.
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
