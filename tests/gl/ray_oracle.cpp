#include "gl/ray_oracle.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace occlod::gl {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

glm::dvec3 to_pixel(const View& view, const glm::dvec3& world) {  // x, y, depth
  const glm::dvec4 clip = view.world_to_clip() * glm::dvec4(world, 1.0);
  return {(clip.x / clip.w + 1.0) * view.width() / 2.0, (clip.y / clip.w + 1.0) * view.height() / 2.0, clip.w};
}

Soup random_occluder(std::mt19937& random) {
  Soup soup;
  const auto point = [&](float size, const glm::vec3& center) {
    return center +
           glm::vec3(uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size) / 2);
  };
  for (int i = 0; i < 16; ++i) {
    const glm::vec3 center = point(0.9F, glm::vec3(0.0F));
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (int k = 0; k < 3; ++k) soup.positions.push_back(point(0.7F, center));
    soup.triangles.emplace_back(first, first + 1, first + 2);
  }
  if (random() % 2U == 0) soup.add_quad({-3, -3, -0.6F}, {3, -3, -0.6F}, {3, 3, -0.2F}, {-3, 3, -0.8F});
  return soup;
}

Soup moved(const Soup& soup, const glm::dmat4& transform) {
  Soup result = soup;
  for (glm::vec3& p : result.positions) p = glm::vec3(transform * glm::dvec4(p, 1.0));
  return result;
}

}  // namespace

RayImage::RayImage(const View& view, const Soup& occluder, const glm::dmat4& object_to_world) : view_(view) {
  for (const glm::vec3& p : occluder.positions) world_.emplace_back(object_to_world * glm::dvec4(p, 1.0));
  pixels_.resize(static_cast<std::size_t>(view.width()) * static_cast<std::size_t>(view.height()));
  for (int y = 0; y < view.height(); ++y)
    for (int x = 0; x < view.width(); ++x) pixels_[index(x, y)] = depths(occluder, x + 0.5, y + 0.5);
}

RayDepth RayImage::depths(const Soup& occluder, double x, double y) const {
  RayDepth result;
  constexpr double d = 1.0 / 64.0;
  for (const glm::dvec2 offset :
       {glm::dvec2(0), glm::dvec2(d, d), glm::dvec2(-d, d), glm::dvec2(d, -d), glm::dvec2(-d, -d)}) {
    const double depth = cast(occluder, glm::dvec2(x, y) + offset);
    result.nearest = std::min(result.nearest, depth);
    result.farthest = std::max(result.farthest, depth);
  }
  return result;
}

// Moller & Trumbore. The direction advances one unit of depth.
double RayImage::cast(const Soup& occluder, const glm::dvec2& pixel) const {
  const double f = view_.focal_length_px();
  const glm::dvec3 direction((pixel.x - view_.width() / 2.0) / f, (pixel.y - view_.height() / 2.0) / f, -1.0);
  double nearest = infinite;
  for (const Triangle& t : occluder.triangles) {
    const glm::dvec3 a = world_[t.x];
    const glm::dvec3 e1 = world_[t.y] - a;
    const glm::dvec3 e2 = world_[t.z] - a;
    const glm::dvec3 p = glm::cross(direction, e2);
    const double det = glm::dot(e1, p);
    if (det == 0.0) continue;
    const glm::dvec3 s = view_.camera().eye - a;
    const double u = glm::dot(s, p) / det;
    const glm::dvec3 q = glm::cross(s, e1);
    const double v = glm::dot(direction, q) / det;
    const double depth = glm::dot(e2, q) / det;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && depth >= view_.camera().near) nearest = std::min(nearest, depth);
  }
  return nearest;
}

Verdict verdict(const View& view, const RayImage& image, const VisibilityQuery& query,
                const glm::dmat4& object_to_world, std::mt19937& random) {
  Verdict result;
  std::vector<glm::dvec3> points;
  points.reserve(300);
  for (int i = 0; i < 300; ++i)
    points.push_back(to_pixel(view, object_to_world * glm::dvec4(random_point(query, random), 1.0)));
  glm::dvec3 low(infinite);
  glm::dvec3 high(-infinite);
  for (const glm::dvec3& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
    const int x = static_cast<int>(std::floor(p.x));
    const int y = static_cast<int>(std::floor(p.y));
    if (x < 0 || y < 0 || x >= view.width() || y >= view.height()) continue;
    if (p.z <= image.at(x, y).nearest) result.must_be_visible = true;
  }
  // Sampling misses up to some tenths of the extent, circumscribing adds a quarter of it in the shape's own axes,
  // growing 2 pixels, a stretch of 2.5 over 0.4 as much again for round shapes.
  const glm::dvec3 room = 0.8 * (high - low) + glm::dvec3(12.0, 12.0, 12.0 / view.focal_length_px() * high.z);
  result.must_be_hidden =
      low.x - room.x < view.width() && high.x + room.x >= 0 && low.y - room.y < view.height() && high.y + room.y >= 0;
  for (int y = std::max(0, static_cast<int>(low.y - room.y)); y < std::min<double>(view.height(), high.y + room.y); ++y)
    for (int x = std::max(0, static_cast<int>(low.x - room.x)); x < std::min<double>(view.width(), high.x + room.x);
         ++x)
      if (image.at(x, y).farthest > low.z - room.z) result.must_be_hidden = false;
  return result;
}

RandomScene::RandomScene(const View& view, std::mt19937& random)
    : view_(view),
      random_(random),
      transform_(random_linear(random)),
      to_object_(glm::inverse(transform_)),
      world_(random_occluder(random)),
      soup_(moved(world_, to_object_)),
      image_(view, soup_, transform_) {}

VisibilityQuery RandomScene::next_bound(ProxyShape shape) {
  glm::dvec3 center(uniform(random_, -1.3F, 1.3F), uniform(random_, -1, 1), uniform(random_, -4, 1));
  const float size = std::exp(uniform(random_, -9, -1));
  // Every third bound is centred on the occluder itself: it touches it.
  if (bounds_++ % 3 == 0) center = glm::dvec3(world_.positions[random_() % world_.positions.size()]);
  return random_bound(shape, glm::vec3(to_object_ * glm::dvec4(center, 1.0)), size, random_);
}

}  // namespace occlod::gl
