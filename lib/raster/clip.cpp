#include "raster/clip.h"

#include <algorithm>
#include <cmath>

namespace occlod::raster {
namespace {

// Inside: limit * w >= sign * v[axis].
struct Plane {
  int axis;
  double sign;
  double limit;

  [[nodiscard]] double distance(const glm::dvec4& v) const { return limit * v.w - sign * v[axis]; }
};

// Always walks from the inside to the outside corner: the same result for both triangles of an edge. Huge corners
// cancel badly, so the coordinate that is known is set.
glm::dvec4 intersect(const Plane& plane, const glm::dvec4& inside, const glm::dvec4& outside) {
  const double distance = plane.distance(inside);
  glm::dvec4 v = inside + distance / (distance - plane.distance(outside)) * (outside - inside);
  v[plane.axis] = plane.sign * plane.limit * v.w;
  return v;
}

// Sutherland & Hodgman 1974.
void clip_against(const Plane& plane, ClipPolygon& polygon) {
  ClipPolygon result;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const glm::dvec4& a = polygon.corners[i];
    const glm::dvec4& b = polygon.corners[i + 1 < polygon.size ? i + 1 : 0];
    const bool a_inside = plane.distance(a) >= 0.0;
    const bool b_inside = plane.distance(b) >= 0.0;
    if (a_inside) result.corners[result.size++] = a;
    if (a_inside && !b_inside) result.corners[result.size++] = intersect(plane, a, b);
    if (!a_inside && b_inside) result.corners[result.size++] = intersect(plane, b, a);
  }
  polygon = result;
}

bool finite(const glm::dvec4& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

// All corners beyond one side of the image or before the near plane.
bool outside_image(const std::array<glm::dvec4, 3>& triangle) {
  const auto all = [&](auto beyond) { return std::all_of(triangle.begin(), triangle.end(), beyond); };
  return all([](const glm::dvec4& v) { return v.x < -v.w; }) || all([](const glm::dvec4& v) { return v.x > v.w; }) ||
         all([](const glm::dvec4& v) { return v.y < -v.w; }) || all([](const glm::dvec4& v) { return v.y > v.w; }) ||
         all([](const glm::dvec4& v) { return v.z < -v.w; });
}

}  // namespace

ClipPolygon clip_triangle(const std::array<glm::dvec4, 3>& triangle, const glm::dvec2& guard) {
  ClipPolygon polygon;
  if (!std::all_of(triangle.begin(), triangle.end(), finite) || outside_image(triangle)) return polygon;
  std::copy(triangle.begin(), triangle.end(), polygon.corners.begin());
  polygon.size = 3;
  clip_against({2, -1.0, 1.0}, polygon);
  clip_against({0, -1.0, guard.x}, polygon);
  clip_against({0, 1.0, guard.x}, polygon);
  clip_against({1, -1.0, guard.y}, polygon);
  clip_against({1, 1.0, guard.y}, polygon);
  return polygon;
}

}  // namespace occlod::raster
