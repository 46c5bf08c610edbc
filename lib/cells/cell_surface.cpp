#include "cells/cell_surface.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x3.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/placement.h"
#include "cells/cell_geometry.h"
#include "occlod/build_hierarchy.h"

namespace occlod {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

float rounded_down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafter(f, -infinity) : f;
}

}  // namespace

// Implements the test of Moeller and Trumbore 1997.
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
    node.max[static_cast<std::size_t>(k)] = -rounded_down(-box.max[k]);
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

CellSurface::CellSurface(std::span<const RefineObject> objects, double max_motion) {
  std::map<std::pair<const Hierarchy*, double>, MotionCut> cuts;  // instances of one hierarchy may share them
  for (const RefineObject& object : objects) {
    const double stretch = stretch_of(glm::dmat3(object.object_to_world));
    const auto [cut, is_new] = cuts.try_emplace({object.hierarchy, max_motion / stretch});
    if (is_new) cut->second = cut_of(*object.hierarchy, max_motion / stretch);
    add(object, cut->second, stretch);
  }
  finish();
}

CellSurface::CellSurface(std::vector<glm::dvec3> positions, std::span<const Triangle> triangles,
                         std::span<const float> moved)
    : positions_(std::move(positions)) {
  for (std::size_t i = 0; i < triangles.size(); ++i)
    add_triangle(triangles[i], moved.empty() ? 0.0 : static_cast<double>(moved[i]));
  finish();
}

MotionCut CellSurface::cut_of(const Hierarchy& hierarchy, double max_motion) {
  if (max_motion > 0.0) return cut_to_motion(hierarchy, max_motion);
  MotionCut cut{triangles_of(hierarchy, full_cut(hierarchy)), {}};
  cut.moved.assign(cut.triangles.size(), 0.0F);
  return cut;
}

void CellSurface::add(const RefineObject& object, const MotionCut& cut, double scale) {
  const Hierarchy& hierarchy = *object.hierarchy;
  const glm::dmat4x3 to_world(object.object_to_world);
  std::vector<std::uint32_t> place_of(hierarchy.vertex_count(), no_id);
  for (std::size_t i = 0; i < cut.triangles.size(); ++i) {
    Triangle t;
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& place = place_of[cut.triangles[i][k]];
      if (place == no_id) {
        place = static_cast<std::uint32_t>(positions_.size());
        positions_.push_back(to_world * glm::dvec4(hierarchy.positions()[cut.triangles[i][k]], 1.0));
      }
      t[k] = place;
    }
    add_triangle(t, static_cast<double>(cut.moved[i]) * scale);
  }
}

void CellSurface::add_triangle(const Triangle& t, double moved) {
  if (t.x == t.y || t.y == t.z || t.z == t.x) return;
  triangles_.push_back(t);
  moved_.push_back(moved > 0.0 ? std::nextafter(static_cast<float>(moved), std::numeric_limits<float>::infinity())
                               : 0.0F);
}

void CellSurface::finish() {
  drop_duplicates();
  std::vector<std::uint32_t> order;
  bvh_ = TriangleBvh(positions_, triangles_, order);
  sort(order);
  join_edges();
  for (const glm::dvec3& p : positions_) {
    const glm::dvec3 size = glm::abs(p);
    largest_coordinate_ = std::max({largest_coordinate_, size.x, size.y, size.z});
  }
}

void CellSurface::sort(std::span<const std::uint32_t> order) {
  std::vector<Triangle> triangles;
  std::vector<float> moved;
  triangles.reserve(order.size());
  moved.reserve(order.size());
  for (const std::uint32_t t : order) {
    triangles.push_back(triangles_[t]);
    moved.push_back(moved_[t]);
  }
  triangles_ = std::move(triangles);
  moved_ = std::move(moved);
  std::vector<std::uint32_t> place_of(positions_.size(), no_id);
  std::vector<glm::dvec3> positions;
  for (Triangle& t : triangles_)
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& place = place_of[t[k]];
      if (place == no_id) {
        place = static_cast<std::uint32_t>(positions.size());
        positions.push_back(positions_[t[k]]);
      }
      t[k] = place;
    }
  positions_ = std::move(positions);
}

// Drops duplicates: a sheet that is given once for each side would have no inside and no border that an odd number of
// triangles share. The hull test allows any set of triangles, so also one without the second copies.
void CellSurface::drop_duplicates() {
  struct Entry {
    std::uint32_t a, b, c;  // ascending
    float moved;
    std::uint32_t triangle;
  };
  std::vector<Entry> entries;
  entries.reserve(triangles_.size());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    std::uint32_t corners[] = {triangles_[t].x, triangles_[t].y, triangles_[t].z};
    std::sort(std::begin(corners), std::end(corners));
    entries.push_back({corners[0], corners[1], corners[2], moved_[t], t});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& x, const Entry& y) {
    return std::tie(x.a, x.b, x.c, x.moved, x.triangle) < std::tie(y.a, y.b, y.c, y.moved, y.triangle);
  });
  std::vector<bool> kept(triangles_.size(), false);
  for (std::size_t i = 0; i < entries.size(); ++i)
    kept[entries[i].triangle] = i == 0 || std::tie(entries[i].a, entries[i].b, entries[i].c) !=
                                              std::tie(entries[i - 1].a, entries[i - 1].b, entries[i - 1].c);
  std::size_t count = 0;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    if (!kept[t]) continue;
    triangles_[count] = triangles_[t];
    moved_[count++] = moved_[t];
  }
  triangles_.resize(count);
  moved_.resize(count);
}

void CellSurface::join_edges() {
  struct Entry {
    std::uint32_t low, high, edge;
  };
  std::vector<Entry> entries;
  entries.reserve(3 * triangles_.size());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const VertexId a = triangles_[t][static_cast<int>(k)], b = triangles_[t][k == 2 ? 0 : static_cast<int>(k) + 1];
      entries.push_back({std::min(a, b), std::max(a, b), 3 * t + k});
    }
  std::sort(entries.begin(), entries.end(), [](const Entry& x, const Entry& y) {
    return std::tie(x.low, x.high, x.edge) < std::tie(y.low, y.high, y.edge);
  });
  beyond_.resize(entries.size());
  is_border_.assign(entries.size(), false);
  for (std::size_t first = 0, last = 0; first < entries.size(); first = last) {
    while (last < entries.size() && entries[last].low == entries[first].low &&
           entries[last].high == entries[first].high)
      ++last;
    for (std::size_t i = first; i < last; ++i) {
      beyond_[entries[i].edge] = entries[i + 1 == last ? first : i + 1].edge;
      is_border_[entries[i].edge] = (last - first) % 2 == 1;
    }
  }
}

}  // namespace occlod
