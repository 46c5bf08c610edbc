#include "cells/triangle_bvh.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <utility>

#include "cells/cell_geometry.h"

namespace occlod {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

float rounded_down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafter(f, -infinity) : f;
}
float rounded_up(double x) { return -rounded_down(-x); }

}  // namespace

bool TriangleBvh::meets(const Node& node, const glm::dvec3& from, const glm::dvec3& inverse) {
  double first = 0.0, last = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const double a = (static_cast<double>(node.min[i]) - from[axis]) * inverse[axis];
    const double b = (static_cast<double>(node.max[i]) - from[axis]) * inverse[axis];
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

TriangleBvh::TriangleBvh(std::span<const glm::dvec3> positions, std::span<const Triangle> triangles,
                         std::vector<std::uint32_t>& order)
    : count_(static_cast<std::uint32_t>(triangles.size())) {
  order.resize(triangles.size());
  std::iota(order.begin(), order.end(), 0U);
  std::vector<CellBox> boxes;
  boxes.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const glm::dvec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
    boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
  }
  if (!triangles.empty()) build(boxes, order);
}

void TriangleBvh::build(std::span<const CellBox> boxes, std::span<std::uint32_t> order) {
  const std::size_t place = nodes_.size();
  CellBox box = boxes[order[0]];
  for (const std::uint32_t t : order) box = unite(box, boxes[t]);
  const int axis = longest_axis(box);
  Node node{.axis = static_cast<std::uint32_t>(axis)};
  for (int k = 0; k < 3; ++k) {
    node.min[static_cast<std::size_t>(k)] = rounded_down(box.min[k]);
    node.max[static_cast<std::size_t>(k)] = rounded_up(box.max[k]);
  }
  nodes_.push_back(node);
  if (order.size() <= leaf_size) return;
  const auto key = [&](std::uint32_t t) { return std::pair(boxes[t].min[axis] + boxes[t].max[axis], t); };
  const std::size_t half = order.size() / 2;
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  build(boxes, order.first(half));
  nodes_[place].right = static_cast<std::uint32_t>(nodes_.size());
  build(boxes, order.subspan(half));
}

}  // namespace occlod
