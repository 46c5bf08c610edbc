#include "scene/shading.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <vector>

#include "base/threads.h"
#include "raster/draw_bands.h"

namespace occlod {

namespace picture {

ItemTable::ItemTable(std::span<const DrawObject> objects) : objects_(objects), first_items_(1, 0) {
  for (const DrawObject& object : objects)
    first_items_.push_back(first_items_.back() + static_cast<std::uint32_t>(object.triangles.size()));
}

ItemTable::Owner ItemTable::owner(std::uint32_t item) const {
  assert(item < size());
  const auto next = std::upper_bound(first_items_.begin(), first_items_.end(), item);
  const auto object = static_cast<std::size_t>(next - first_items_.begin()) - 1;
  return {&objects_[object], &objects_[object].triangles[item - first_items_[object]]};
}

std::array<glm::dvec3, 3> world_corners(const ItemTable::Owner& owner) {
  std::array<glm::dvec3, 3> corners;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec4 position(owner.object->positions[(*owner.triangle)[i]], 1.0);
    corners[static_cast<std::size_t>(i)] = glm::dvec3(owner.object->object_to_world * position);
  }
  return corners;
}

}  // namespace picture

void draw_items(ItemBuffer& target, std::span<const DrawObject> objects, const View& view, int threads) {
  const picture::ItemTable table(objects);
  target.reset(view.width(), view.height());
  std::vector<raster::DrawPart> parts;
  for (std::size_t i = 0; i < objects.size(); ++i)
    parts.push_back({objects[i].positions, objects[i].triangles,
                     ObjectView(view, objects[i].object_to_world).object_to_clip(), table.first_item(i)});
  raster::BandDrawing().draw_items(target, parts, thread_count(threads));
}

}  // namespace occlod

namespace occlod::picture {
namespace {

double inscribed_diameter(const std::array<glm::dvec3, 3>& p) {
  if (!(p[0].z > 0.0 && p[1].z > 0.0 && p[2].z > 0.0)) return std::numeric_limits<double>::infinity();
  const glm::dvec2 a = glm::dvec2(p[0]) / p[0].z;
  const glm::dvec2 b = glm::dvec2(p[1]) / p[1].z;
  const glm::dvec2 c = glm::dvec2(p[2]) / p[2].z;
  const glm::dvec2 ab = b - a, ac = c - a;
  const double perimeter = glm::length(ab) + glm::length(ac) + glm::length(c - b);
  return perimeter > 0.0 ? 2.0 * std::abs(ab.x * ac.y - ab.y * ac.x) / perimeter : 0.0;
}

}  // namespace

ScreenTriangle::ScreenTriangle(const std::array<glm::dvec3, 3>& corners, const View& view) {
  std::array<glm::dvec3, 3> p;
  const glm::dvec2 half = glm::dvec2(view.width(), view.height()) / 2.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec4 clip = view.world_to_clip() * glm::dvec4(corners[i], 1.0);
    p[i] = {(clip.w + clip.x) * half.x, (clip.w - clip.y) * half.y, clip.w};
  }
  for (std::size_t i = 0; i < 3; ++i) edges_[i] = glm::cross(p[(i + 1) % 3], p[(i + 2) % 3]);
  diameter_px_ = inscribed_diameter(p);
}

glm::vec3 ScreenTriangle::barycentric(const glm::dvec2& pixel) const {
  const glm::dvec3 e = at(pixel);
  const double sum = e.x + e.y + e.z;
  return sum == 0.0 ? glm::vec3(1.0F / 3.0F) : glm::clamp(glm::vec3(e / sum), 0.0F, 1.0F);
}

glm::dvec3 ScreenTriangle::exact_barycentric(const glm::dvec2& pixel) const {
  const glm::dvec3 e = at(pixel);
  return e / (e.x + e.y + e.z);
}

glm::dvec3 ScreenTriangle::barycentric_step(const glm::dvec2& pixel, int axis) const {
  // Quotient rule: d (e / s) = (e' s - e s') / s^2.
  const glm::dvec3 e = at(pixel), slope(edges_[0][axis], edges_[1][axis], edges_[2][axis]);
  const double sum = e.x + e.y + e.z, sum_slope = slope.x + slope.y + slope.z;
  return (slope * sum - e * sum_slope) / (sum * sum);
}

double ScreenTriangle::edge_distance_px(const glm::dvec2& pixel) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& edge : edges_)
    nearest = std::min(nearest, std::abs(glm::dot(edge, glm::dvec3(pixel, 1.0))) / glm::length(glm::dvec2(edge)));
  return nearest;
}

glm::dvec3 ScreenTriangle::at(const glm::dvec2& pixel) const {
  const glm::dvec3 q(pixel, 1.0);
  return {glm::dot(edges_[0], q), glm::dot(edges_[1], q), glm::dot(edges_[2], q)};
}

}  // namespace occlod::picture
