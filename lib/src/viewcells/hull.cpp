#include "viewcells/hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "viewcells/cell_geometry.h"

namespace occlod {
namespace {

// A convex polygon in the unit square, cut by half-planes.
class CutSquare {
 public:
  // Keeps what has constant + by_t t + by_u u >= 0. False when nothing is left.
  bool keep(double constant, double by_t, double by_u) {
    std::array<glm::dvec2, most> kept;
    std::array<double, most> value;
    bool all = true;
    for (std::size_t i = 0; i < size_; ++i) {
      value[i] = constant + by_t * corners_[i].x + by_u * corners_[i].y;
      all = all && value[i] >= 0.0;
    }
    if (all) return true;
    std::size_t count = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const std::size_t j = i + 1 == size_ ? 0 : i + 1;
      if (value[i] >= 0.0) kept[count++] = corners_[i];
      if ((value[i] >= 0.0) != (value[j] >= 0.0))
        kept[count++] = glm::mix(corners_[i], corners_[j], value[i] / (value[i] - value[j]));
    }
    corners_ = kept;
    size_ = count;
    return count > 0;
  }

 private:
  static constexpr std::size_t most = 4 + 6;  // each line adds one corner at most
  std::array<glm::dvec2, most> corners_ = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  std::size_t size_ = 4;
};

// Whether [low, high], which runs over the projections of the corners onto an axis, is apart from the box's.
bool apart(const glm::dvec3& axis, const std::array<glm::dvec3, 3>& corners, const glm::dvec3& half) {
  const double p = glm::dot(axis, corners[0]), q = glm::dot(axis, corners[1]), r = glm::dot(axis, corners[2]);
  const double reach = glm::dot(glm::abs(axis), half);
  return std::min({p, q, r}) > reach || std::max({p, q, r}) < -reach;
}

}  // namespace

Hull::Hull(const CellBox& eyes, const CellBox& what) : eyes_(eyes), what_(what), around_(unite(eyes, what)) {}

// A point of the segment is a + u (b - a); it lies in the box for t iff six numbers that are linear in t and u are
// not negative.
bool Hull::may_meet(const glm::dvec3& a, const glm::dvec3& b, double margin) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::min(a[axis], b[axis]) > around_.max[axis] + margin) return false;
    if (std::max(a[axis], b[axis]) < around_.min[axis] - margin) return false;
  }
  CutSquare left;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = b[axis] - a[axis];
    if (!left.keep(a[axis] - eyes_.min[axis] + margin, eyes_.min[axis] - what_.min[axis], along)) return false;
    if (!left.keep(eyes_.max[axis] - a[axis] + margin, what_.max[axis] - eyes_.max[axis], -along)) return false;
  }
  return true;
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

}  // namespace occlod
