#include "oracle/random_shapes.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

namespace occlod::test {

const char* label(BoundKind kind) {
  switch (kind) {
    case BoundKind::sphere:
      return "sphere";
    case BoundKind::box:
      return "box";
    case BoundKind::cylinder:
      return "cylinder";
    default:
      return "hull";
  }
}

// Not std::uniform_real_distribution, whose numbers differ between standard libraries.
double RandomShapes::in(double low, double high) {
  return low + (high - low) * static_cast<double>(random_()) * 0x1p-32;
}

int RandomShapes::below(int end) { return static_cast<int>(random_() % static_cast<std::uint32_t>(end)); }

glm::dvec3 RandomShapes::point(double range) {
  glm::dvec3 p;
  for (int axis = 0; axis < 3; ++axis) p[axis] = in(-range, range);
  return p;
}

glm::dvec3 RandomShapes::unit() {
  for (;;) {
    const glm::dvec3 p = point(1.0);
    if (glm::length(p) > 0.1 && glm::length(p) < 1.0) return glm::normalize(p);
  }
}

View RandomShapes::view() {
  Camera camera;
  camera.eye = point(4.0);
  camera.target = camera.eye + unit();
  camera.up = unit();
  camera.fov_y_deg = in(20.0, 110.0);
  camera.width = static_cast<int>(in(20.0, 200.0));
  camera.height = static_cast<int>(in(20.0, 200.0));
  camera.near = 0.1;
  if (below(3) == 0) camera.principal_point = {in(-1.5, 1.5), in(-1.5, 1.5)};
  if (below(4) == 0)
    camera.principal_point = glm::dvec2(0.0), camera.orthographic_height = in(1.0, 10.0), camera.far = in(5.0, 20.0);
  return View(camera);
}

glm::dmat4 RandomShapes::rotation() {
  const double angle = in(0.0, 2.0 * std::numbers::pi);
  return glm::rotate(glm::dmat4(1.0), angle, unit());
}

glm::dmat4 RandomShapes::linear() {
  const glm::dmat4 first = rotation();
  glm::dvec3 scale;
  for (int axis = 0; axis < 3; ++axis) scale[axis] = in(0.3, 2.0);
  if (in(0.0, 1.0) < 0.5) scale.z = -scale.z;
  return glm::scale(first, scale) * rotation();
}

glm::dmat4 RandomShapes::placement() {
  const glm::dmat4 moved = glm::translate(glm::dmat4(1.0), point(3.0));
  return moved * linear();
}

VisibilityQuery RandomShapes::bound(BoundKind kind, const glm::vec3& center, double size, std::uint32_t object) {
  const auto length = [&] { return static_cast<float>(in(0.0, size)); };
  switch (kind) {
    case BoundKind::sphere:
      return {object, Sphere{center, length()}};
    case BoundKind::box: {
      const glm::vec3 below_center(point(size / 2.0) + size / 2.0), above_center(point(size / 2.0) + size / 2.0);
      return {object, Box{center - below_center, center + above_center}};
    }
    case BoundKind::cylinder: {
      const float radius = length();
      const glm::vec3 axis(unit());
      const auto t_min = static_cast<float>(in(-size, size));
      return {object, Cylinder{center, radius, axis, t_min, t_min + length()}};
    }
    default: {
      std::vector<glm::vec3>& points = hulls_.emplace_back();
      for (int i = 0; i < 7; ++i) points.push_back(center + glm::vec3(point(size)));
      return {object, PointHull{points}};
    }
  }
}

VisibilityQuery RandomShapes::bound(BoundKind kind, double size) {
  const glm::vec3 center(point(4.0));
  return bound(kind, center, size);
}

glm::dvec3 RandomShapes::sample(const VisibilityQuery& bound) {
  return std::visit([this](const auto& shape) { return sample_of(shape); }, bound.shape);
}

glm::dvec3 RandomShapes::sample_of(const Sphere& sphere) {
  const double distance = double{sphere.radius} * shrink();
  return glm::dvec3(sphere.center) + distance * unit();
}

glm::dvec3 RandomShapes::sample_of(const Box& box) {
  glm::dvec3 weight;
  for (int axis = 0; axis < 3; ++axis) {
    weight[axis] = in(0.0, 1.0);
    if (in(0.0, 1.0) < 0.6) weight[axis] = std::round(weight[axis]);
  }
  return glm::dvec3(box.min) + weight * (glm::dvec3(box.max) - glm::dvec3(box.min));
}

glm::dvec3 RandomShapes::sample_of(const Cylinder& cylinder) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(cylinder.axis));
  const glm::dvec3 u =
      glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const double angle = in(0.0, 2.0 * std::numbers::pi);
  const double end = in(0.0, 1.0), between = in(0.0, 1.0);
  const double t = end < 0.4   ? cylinder.t_min
                   : end < 0.8 ? cylinder.t_max
                               : cylinder.t_min + between * (cylinder.t_max - cylinder.t_min);
  const double distance = double{cylinder.radius} * shrink();
  return glm::dvec3(cylinder.center) + t * axis +
         distance * (std::cos(angle) * u + std::sin(angle) * glm::cross(axis, u));
}

glm::dvec3 RandomShapes::sample_of(const PointHull& hull) {
  if (in(0.0, 1.0) < 0.4) return hull.points[static_cast<std::size_t>(below(static_cast<int>(hull.points.size())))];
  glm::dvec3 sum(0.0);
  double weights = 0.0;
  for (const glm::vec3& p : hull.points) {
    const double weight = std::pow(in(0.0, 1.0), 4) + 1e-9;
    sum += weight * glm::dvec3(p);
    weights += weight;
  }
  return sum / weights;
}

std::optional<Projected> project(const View& view, const glm::dmat4& object_to_world, const glm::dvec3& p) {
  const glm::dvec4 clip = view.world_to_clip() * object_to_world * glm::dvec4(p, 1.0);
  if (clip.z < -clip.w) return std::nullopt;
  return Projected{(clip.x / clip.w * 0.5 + 0.5) * view.width(), (0.5 - clip.y / clip.w * 0.5) * view.height(),
                   view.is_orthographic() ? (1.0 - clip.z) / 2.0 : 1.0 / clip.w};
}

}  // namespace occlod::test
