// Random views, placements and bounds, and points of those bounds.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>
#include <random>
#include <vector>

#include "occlod/refine/visibility.h"
#include "occlod/view/view.h"

namespace occlod::test {

class RandomShapes {
 public:
  explicit RandomShapes(unsigned seed) : random_(seed) {}

  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  glm::dvec3 point(double range) { return {in(-range, range), in(-range, range), in(-range, range)}; }
  glm::dvec3 unit() {
    for (;;) {
      const glm::dvec3 p = point(1.0);
      if (glm::length(p) > 0.1 && glm::length(p) < 1.0) return glm::normalize(p);
    }
  }

  View view() {
    Camera camera;
    camera.eye = point(4.0);
    camera.target = camera.eye + unit();
    camera.up = unit();
    camera.fov_y_deg = in(20.0, 110.0);
    camera.width = static_cast<int>(in(20.0, 200.0));
    camera.height = static_cast<int>(in(20.0, 200.0));
    camera.near = 0.1;
    return View(camera);
  }

  // A rotation, a scale that differs by axis and may mirror, and a translation.
  glm::dmat4 placement() {
    glm::dmat4 m = glm::translate(glm::dmat4(1.0), point(3.0));
    m = glm::rotate(m, in(0.0, 6.0), unit());
    return glm::scale(m, glm::dvec3(in(0.3, 2.0), in(0.3, 2.0), in(0.3, 2.0) * (in(0.0, 1.0) < 0.5 ? -1.0 : 1.0)));
  }

  // kind 0..3: sphere, box, cylinder, hull; `storage` keeps the points of a hull.
  VisibilityQuery query(int kind, double size, std::vector<glm::vec3>& storage) {
    const glm::vec3 center(point(4.0));
    if (kind == 0) return {0, Sphere{center, static_cast<float>(in(0.0, size))}};
    if (kind == 1)
      return {0, Box{center - glm::vec3(point(size / 2) + size / 2), center + glm::vec3(point(size / 2) + size / 2)}};
    if (kind == 2) {
      const double t = in(-size, size);
      return {0, Cylinder{center, static_cast<float>(in(0.0, size)), glm::vec3(unit()), static_cast<float>(t),
                          static_cast<float>(t + in(0.0, size))}};
    }
    storage.clear();
    for (int i = 0; i < 7; ++i) storage.push_back(center + glm::vec3(point(size)));
    return {0, PointHull{storage}};
  }

  // A point of the bound, most often on its surface; object space.
  glm::dvec3 sample(const VisibilityQuery& query) {
    return std::visit([this](const auto& shape) { return sample_of(shape); }, query.shape);
  }

 private:
  double shrink() { return in(0.0, 1.0) < 0.8 ? 1.0 : in(0.0, 1.0); }

  glm::dvec3 sample_of(const Sphere& s) { return glm::dvec3(s.center) + double{s.radius} * shrink() * unit(); }
  glm::dvec3 sample_of(const Box& b) {
    const auto weight = [&] { return in(0.0, 1.0) < 0.6 ? std::round(in(0.0, 1.0)) : in(0.0, 1.0); };
    const glm::dvec3 w(weight(), weight(), weight());
    return glm::dvec3(b.min) + w * (glm::dvec3(b.max) - glm::dvec3(b.min));
  }
  glm::dvec3 sample_of(const Cylinder& c) {
    const glm::dvec3 axis = glm::normalize(glm::dvec3(c.axis));
    const glm::dvec3 u =
        glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const double angle = in(0.0, 2.0 * M_PI);
    const double end = in(0.0, 1.0);
    const double t = end < 0.4 ? c.t_min : end < 0.8 ? c.t_max : c.t_min + in(0.0, 1.0) * (c.t_max - c.t_min);
    return glm::dvec3(c.center) + t * axis +
           double{c.radius} * shrink() * (std::cos(angle) * u + std::sin(angle) * glm::cross(axis, u));
  }
  glm::dvec3 sample_of(const PointHull& hull) {
    if (in(0.0, 1.0) < 0.4)
      return hull.points[static_cast<std::size_t>(in(0.0, 0.999) * static_cast<double>(hull.points.size()))];
    glm::dvec3 sum(0.0);
    double weights = 0.0;
    for (const glm::vec3& p : hull.points) {
      const double w = std::pow(in(0.0, 1.0), 4);
      sum += w * glm::dvec3(p);
      weights += w;
    }
    return sum / weights;
  }

  std::mt19937 random_;
};

// Where a point of an object is on the screen, in double from the exact matrices.
struct Projected {
  double x, y;  // pixels
  double inverse_w;
};

// Nothing before the near plane.
inline std::optional<Projected> project(const View& view, const glm::dmat4& object_to_world, const glm::dvec3& p) {
  const glm::dvec4 clip = view.world_to_clip() * object_to_world * glm::dvec4(p, 1.0);
  if (clip.z < -clip.w) return std::nullopt;
  return Projected{(clip.x / clip.w * 0.5 + 0.5) * view.width(), (0.5 - clip.y / clip.w * 0.5) * view.height(),
                   1.0 / clip.w};
}

}  // namespace occlod::test
