#include "viewcells/triangle_bvh.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

#include "viewcells/cell_geometry.h"

namespace occlod {

bool TriangleBvh::meets(const CellBox& box, const glm::dvec3& from, const glm::dvec3& inverse) {
  double first = 0.0, last = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.min[axis] - from[axis]) * inverse[axis], b = (box.max[axis] - from[axis]) * inverse[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last + 1e-12;
}

// Moeller and Trumbore 1997.
bool TriangleBvh::meets(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& from,
                        const glm::dvec3& along) {
  const glm::dvec3 u = b - a, v = c - a, p = glm::cross(along, v);
  const double det = glm::dot(u, p);
  if (det == 0.0) return false;
  const glm::dvec3 s = from - a, q = glm::cross(s, u);
  const double x = glm::dot(s, p) / det, y = glm::dot(along, q) / det, t = glm::dot(v, q) / det;
  return x >= 0.0 && y >= 0.0 && x + y <= 1.0 && t >= 0.0 && t <= 1.0;
}

TriangleBvh::TriangleBvh(std::span<const glm::dvec3> positions, std::span<const Triangle> triangles)
    : order_(triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  std::vector<CellBox> boxes;
  boxes.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const glm::dvec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
    boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
  }
  nodes_.reserve(triangles.size());
  if (!triangles.empty()) build(boxes, 0, static_cast<std::uint32_t>(triangles.size()));
}

void TriangleBvh::build(std::span<const CellBox> boxes, std::uint32_t first, std::uint32_t count) {
  const std::size_t place = nodes_.size();
  CellBox box = boxes[order_[first]];
  for (std::uint32_t i = 1; i < count; ++i) box = unite(box, boxes[order_[first + i]]);
  nodes_.push_back({box, first, count, 0});
  if (count <= leaf_size) return;
  const glm::dvec3 size = box.max - box.min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto key = [&](std::uint32_t t) { return std::pair(boxes[t].min[axis] + boxes[t].max[axis], t); };
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count,
                   [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  nodes_[place].count = 0;
  build(boxes, first, count / 2);
  nodes_[place].right = static_cast<std::uint32_t>(nodes_.size());
  build(boxes, first + count / 2, count - count / 2);
}

}  // namespace occlod
