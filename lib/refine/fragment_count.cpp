#include "refine/fragment_count.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include "raster/clip.h"

namespace occlod {
namespace {

// The part of the image, whose area is 4 in normalised device coordinates, that the triangle covers.
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
    // As Occluder does.
    if (two_sided || !(glm::dot(glm::cross(b - a, c - a), view.eye() - a) < 0.0F)) result.front += one;
  }
  return result;
}

}  // namespace occlod
