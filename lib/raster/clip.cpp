#include "raster/clip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

namespace occlod::raster {
namespace {

// A point is inside when limit * w >= sign * v[axis].
struct Plane {
  int axis;
  double sign;
  double limit;

  [[nodiscard]] double distance(const glm::dvec4& v) const { return limit * v.w - sign * v[axis]; }
};

// Always goes from the inside to the outside corner, so that both triangles of an edge get the same result. The known
// coordinate is set explicitly, because it would lose its digits by cancellation for huge corners.
glm::dvec4 intersect(const Plane& plane, const glm::dvec4& inside, const glm::dvec4& outside) {
  const double distance = plane.distance(inside);
  glm::dvec4 v = inside + distance / (distance - plane.distance(outside)) * (outside - inside);
  v[plane.axis] = plane.sign * plane.limit * v.w;
  return v;
}

// Clips a polygon (Sutherland & Hodgman 1974).
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

// True when all corners are beyond one side of the image or nearer than the near plane.
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

namespace occlod {
namespace {

// Returns the part of the image, whose area is 4 in normalised device coordinates, that the triangle covers.
double covered_part(const std::array<glm::dvec4, 3>& triangle) {
  const raster::ClipPolygon polygon = raster::clip_triangle(triangle, {1.0, 1.0});
  if (polygon.size < 3) return 0.0;
  const auto corner = [&](std::size_t i) { return glm::dvec2(polygon.corners[i]) / polygon.corners[i].w; };
  double twice_area = 0.0;
  for (std::size_t i = 1; i + 1 < polygon.size; ++i) {
    const glm::dvec2 a = corner(i) - corner(0), b = corner(i + 1) - corner(0);
    twice_area += a.x * b.y - a.y * b.x;
  }
  return std::isfinite(twice_area) ? std::abs(twice_area) / 8.0 : 0.0;
}

}  // namespace

MeshFragments count_fragments(std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                              const ObjectView& view, bool two_sided, std::size_t step) {
  const glm::dmat4 to_clip(view.object_to_clip());
  const auto weight = static_cast<double>(step);
  MeshFragments result;
  for (std::size_t i = 0; i < triangles.size(); i += step) {
    const Triangle& t = triangles[i];
    const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
    const FragmentCount one{weight, weight * covered_part({to_clip * glm::dvec4(a, 1.0), to_clip * glm::dvec4(b, 1.0),
                                                           to_clip * glm::dvec4(c, 1.0)})};
    result.all += one;
    // Occluder uses the same test.
    if (two_sided || !(glm::dot(glm::cross(b - a, c - a), view.eye() - a) < 0.0F)) result.front += one;
  }
  return result;
}

}  // namespace occlod
