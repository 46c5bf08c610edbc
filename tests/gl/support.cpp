#include "gl/support.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <variant>

#include "occlod/core/error.h"

namespace occlod::gl {

std::shared_ptr<Context> context_or_null(Platform platform, std::string& why) {
  try {
    return create_context(platform);
  } catch (const Error& error) {
    why = error.what();
    return nullptr;
  }
}

std::string platform_label(Platform platform) { return platform == Platform::egl ? "egl" : "osmesa"; }

std::string shape_label(ProxyShape shape) {
  return shape == ProxyShape::sphere ? "sphere" : shape == ProxyShape::box ? "box" : "cylinder";
}

View test_view() {
  Camera camera;
  camera.width = 64;
  camera.height = 48;
  camera.near = 0.1;
  camera.far = 10.0;
  return View(camera);
}

void Soup::add_quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
  const auto first = static_cast<std::uint32_t>(positions.size());
  positions.insert(positions.end(), {a, b, c, d});
  triangles.emplace_back(first, first + 1, first + 2);
  triangles.emplace_back(first, first + 2, first + 3);
}

Soup wall() {
  Soup soup;
  soup.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  return soup;
}

Soup wall_with_hole(float x0, float x1, float y0, float y1) {
  Soup soup;
  soup.add_quad({-1, -1, 0}, {x0, -1, 0}, {x0, 1, 0}, {-1, 1, 0});
  soup.add_quad({x1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {x1, 1, 0});
  soup.add_quad({x0, -1, 0}, {x1, -1, 0}, {x1, y0, 0}, {x0, y0, 0});
  soup.add_quad({x0, y1, 0}, {x1, y1, 0}, {x1, 1, 0}, {x0, 1, 0});
  return soup;
}

VisibilityQuery bound(ProxyShape shape, const glm::vec3& center, const glm::vec3& half, std::uint32_t object) {
  switch (shape) {
    case ProxyShape::sphere:
      return {object, Sphere{center, std::min({half.x, half.y, half.z})}};
    case ProxyShape::box:
      return {object, Box{center - half, center + half}};
    default:
      return {object, Cylinder{center, std::min(half.x, half.y), {0, 0, 1}, -half.z, half.z}};
  }
}

float uniform(std::mt19937& random, float low, float high) {
  // Not std::uniform_real_distribution, whose numbers differ between standard libraries.
  return low + (high - low) * static_cast<float>(random() >> 8U) / 16777216.0F;
}

namespace {

glm::vec3 random_direction(std::mt19937& random) {
  const float z = uniform(random, -1.0F, 1.0F);
  const float angle = uniform(random, 0.0F, 2.0F * std::numbers::pi_v<float>);
  const float r = std::sqrt(std::max(0.0F, 1.0F - z * z));
  return {r * std::cos(angle), r * std::sin(angle), z};
}

struct RandomPoint {
  std::mt19937& random;
  glm::vec3 operator()(const Sphere& s) const { return s.center + s.radius * random_direction(random); }
  glm::vec3 operator()(const Box& b) const {
    glm::vec3 p{};
    for (int i = 0; i < 3; ++i) p[i] = uniform(random, b.min[i], b.max[i]);
    const auto face = static_cast<int>(random() % 3U);
    p[face] = random() % 2U == 0 ? b.min[face] : b.max[face];
    return p;
  }
  glm::vec3 operator()(const Cylinder& c) const {
    const glm::vec3 other = std::abs(c.axis.y) < 0.5F ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
    const glm::vec3 u = glm::normalize(glm::cross(c.axis, other));
    const glm::vec3 v = glm::cross(c.axis, u);
    const float angle = uniform(random, 0.0F, 2.0F * std::numbers::pi_v<float>);
    const float t = random() % 2U == 0 ? uniform(random, c.t_min, c.t_max) : random() % 2U == 0 ? c.t_min : c.t_max;
    return c.center + t * c.axis + c.radius * (std::cos(angle) * u + std::sin(angle) * v);
  }
  glm::vec3 operator()(const PointHull& h) const { return h.points[random() % h.points.size()]; }
};

}  // namespace

VisibilityQuery random_bound(ProxyShape shape, const glm::vec3& center, float size, std::mt19937& random) {
  if (shape == ProxyShape::sphere) return {0, Sphere{center, size}};
  glm::vec3 half{};
  for (int i = 0; i < 3; ++i) half[i] = size * uniform(random, 0.0F, 1.0F);
  if (shape == ProxyShape::box) return {0, Box{center - half, center + half}};
  return {0, Cylinder{center, half.x, random_direction(random), -half.y, half.z}};
}

glm::vec3 random_point(const VisibilityQuery& query, std::mt19937& random) {
  return std::visit(RandomPoint{random}, query.shape);
}

glm::dmat4 random_linear(std::mt19937& random) {
  glm::dmat4 m = glm::rotate(glm::dmat4(1.0), static_cast<double>(uniform(random, 0.0F, 6.0F)),
                             glm::dvec3(random_direction(random)));
  glm::dvec3 scale{};
  for (int i = 0; i < 3; ++i) scale[i] = uniform(random, 0.4F, 2.5F);
  if (random() % 2U == 0) scale.x = -scale.x;
  m = glm::scale(m, scale);
  return glm::rotate(m, static_cast<double>(uniform(random, 0.0F, 6.0F)), glm::dvec3(random_direction(random)));
}

}  // namespace occlod::gl
