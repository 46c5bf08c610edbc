#include "hlod/draw/outline_area.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>

namespace occlod::hlod {
namespace {

constexpr std::size_t most_points = 8;

// A convex polygon; each of the image's four sides cuts off corners and adds one at most.
struct Polygon {
  std::array<glm::dvec2, most_points + 4> corners;
  std::size_t size = 0;

  void add(const glm::dvec2& p) { corners[size++] = p; }
};

double cross(const glm::dvec2& o, const glm::dvec2& a, const glm::dvec2& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

// Andrew's monotone chain: the lower half from left to right, then the upper half back.
Polygon hull_of(std::span<const glm::dvec2> points) {
  std::array<glm::dvec2, most_points> sorted;
  auto end = sorted.begin();
  for (const glm::dvec2& p : points) {
    const auto place = std::upper_bound(sorted.begin(), end, p, [](const glm::dvec2& a, const glm::dvec2& b) {
      return a.x != b.x ? a.x < b.x : a.y < b.y;
    });
    std::move_backward(place, end, end + 1);
    *place = p;
    ++end;
  }
  Polygon hull;
  std::size_t fixed = 1;  // corners that the current half must keep
  const auto extend = [&](const glm::dvec2& p) {
    while (hull.size > fixed && cross(hull.corners[hull.size - 2], hull.corners[hull.size - 1], p) <= 0.0) --hull.size;
    hull.add(p);
  };
  const std::size_t n = points.size();
  hull.add(sorted[0]);
  for (std::size_t i = 1; i < n; ++i) extend(sorted[i]);
  fixed = hull.size;
  for (std::size_t i = n - 1; i-- > 0;) extend(sorted[i]);
  --hull.size;  // the first corner again
  return hull;
}

// What lies where p[axis] >= 0 or, for the opposite side, p[axis] <= end (Sutherland & Hodgman).
Polygon clipped(const Polygon& polygon, int axis, double sign, double end) {
  Polygon result;
  const auto inside = [&](const glm::dvec2& p) { return sign * p[axis] <= end; };
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const glm::dvec2& a = polygon.corners[i];
    const glm::dvec2& b = polygon.corners[(i + 1) % polygon.size];
    if (inside(a)) result.add(a);
    if (inside(a) == inside(b)) continue;
    glm::dvec2 cut = a + (b - a) * ((sign * end - a[axis]) / (b[axis] - a[axis]));
    cut[axis] = sign * end;
    result.add(cut);
  }
  return result;
}

}  // namespace

double hull_area_inside(std::span<const glm::dvec2> points, const glm::dvec2& size) {
  assert(!points.empty() && points.size() <= most_points);
  Polygon polygon = hull_of(points);
  for (int axis = 0; axis < 2; ++axis) {
    polygon = clipped(polygon, axis, -1.0, 0.0);
    polygon = clipped(polygon, axis, 1.0, size[axis]);
  }
  double twice = 0.0;
  for (std::size_t i = 2; i < polygon.size; ++i)
    twice += cross(polygon.corners[0], polygon.corners[i - 1], polygon.corners[i]);
  return std::max(twice / 2.0, 0.0);
}

}  // namespace occlod::hlod
