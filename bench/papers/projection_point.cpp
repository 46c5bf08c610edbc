#include "papers/projection_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace occlod::paper {
namespace {

// A point, line, plane or all of space, where the least of f is sought.
struct Flat {
  glm::dvec3 origin{0.0};
  std::array<glm::dvec3, 3> along{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};  // orthonormal
  int dimensions = 3;

  // Of a vector, the part inside.
  [[nodiscard]] glm::dvec3 part(const glm::dvec3& v) const {
    glm::dvec3 sum(0.0);
    for (int i = 0; i < dimensions; ++i)
      sum += glm::dot(along[static_cast<std::size_t>(i)], v) * along[static_cast<std::size_t>(i)];
    return sum;
  }
};

glm::dvec3 least(const Quadratic& f, const Flat& flat) {
  // Where it has fewer dimensions the rest of the matrix is that of the identity.
  glm::dmat3 h(1.0);
  glm::dvec3 g(0.0);
  const glm::dvec3 slope = f.h * flat.origin + f.c;
  for (int i = 0; i < flat.dimensions; ++i) {
    const glm::dvec3& a = flat.along[static_cast<std::size_t>(i)];
    g[i] = glm::dot(a, slope);
    for (int k = 0; k < flat.dimensions; ++k) h[i][k] = glm::dot(a, f.h * flat.along[static_cast<std::size_t>(k)]);
  }
  const glm::dvec3 y = glm::inverse(h) * -g;
  glm::dvec3 x = flat.origin;
  for (int i = 0; i < flat.dimensions; ++i) x += y[i] * flat.along[static_cast<std::size_t>(i)];
  return x;
}

// Where the flat meets a plane that is not parallel to it; `part` is the part of the plane's normal inside.
Flat cut(const Flat& flat, const HalfSpace& plane, const glm::dvec3& part) {
  Flat result;
  result.origin = flat.origin - plane.distance(flat.origin) / glm::dot(part, part) * part;
  result.dimensions = 0;
  const glm::dvec3 unit = glm::normalize(part);
  // Gram and Schmidt, without the vector that has least left.
  std::array<glm::dvec3, 3> rest{};
  std::array<double, 3> lengths{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(flat.dimensions); ++i) {
    rest[i] = flat.along[i] - glm::dot(flat.along[i], unit) * unit;
    lengths[i] = glm::length(rest[i]);
  }
  const auto dropped =
      static_cast<std::size_t>(std::min_element(lengths.begin(), lengths.begin() + flat.dimensions) - lengths.begin());
  for (std::size_t i = 0; i < static_cast<std::size_t>(flat.dimensions); ++i) {
    if (i == dropped) continue;
    glm::dvec3 a = rest[i];
    for (int k = 0; k < result.dimensions; ++k) {
      const glm::dvec3& b = result.along[static_cast<std::size_t>(k)];
      a -= glm::dot(a, b) * b;
    }
    result.along[static_cast<std::size_t>(result.dimensions++)] = glm::normalize(a);
  }
  return result;
}

std::optional<glm::dvec3> minimise_on(const Quadratic& f, std::span<const HalfSpace> spaces, double slack,
                                      const Flat& flat) {
  glm::dvec3 x = least(f, flat);
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    if (spaces[i].distance(x) <= slack) continue;
    const glm::dvec3 part = flat.part(spaces[i].normal);
    if (glm::dot(part, part) < 1e-18) return std::nullopt;  // the flat lies outside as a whole
    const std::optional<glm::dvec3> there = minimise_on(f, spaces.first(i), slack, cut(flat, spaces[i], part));
    if (!there) return std::nullopt;
    x = *there;
  }
  return x;
}

// What is inside all half-spaces of the plane dot(normal, d) = -1, as a polygon: a large square that is cut again and
// again.
double cross_section(const glm::dvec3& normal, std::span<const HalfSpace> spaces) {
  const glm::dvec3 helper = std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(normal, helper)), w = glm::cross(normal, u);
  constexpr double far = 1e6;
  std::vector<glm::dvec3> polygon;
  for (const auto& [a, b] : {std::pair(-far, -far), std::pair(far, -far), std::pair(far, far), std::pair(-far, far)})
    polygon.push_back(-normal + a * u + b * w);
  for (const HalfSpace& space : spaces) {
    std::vector<glm::dvec3> inside;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double at_a = glm::dot(space.normal, a), at_b = glm::dot(space.normal, b);
      if (at_a <= 0.0) inside.push_back(a);
      if ((at_a < 0.0 && at_b > 0.0) || (at_a > 0.0 && at_b < 0.0))
        inside.push_back(a + at_a / (at_a - at_b) * (b - a));
    }
    polygon = std::move(inside);
  }
  glm::dvec3 area(0.0);
  for (std::size_t i = 2; i < polygon.size(); ++i)
    area += 0.5 * glm::cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return glm::length(area);
}

// The point inside all half-spaces that is farthest along the direction: where three planes meet.
std::optional<glm::dvec3> farthest_point(const glm::dvec3& direction, std::span<const HalfSpace> spaces, double slack) {
  std::optional<glm::dvec3> best;
  for (std::size_t i = 0; i < spaces.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (std::size_t k = 0; k < j; ++k) {
        const glm::dmat3 m = glm::transpose(glm::dmat3(spaces[i].normal, spaces[j].normal, spaces[k].normal));
        if (std::abs(glm::determinant(m)) < 1e-9) continue;
        const glm::dvec3 p = glm::inverse(m) * glm::dvec3(spaces[i].offset, spaces[j].offset, spaces[k].offset);
        if (best && glm::dot(direction, p) <= glm::dot(direction, *best)) continue;
        const auto holds = [&](const HalfSpace& space) { return space.distance(p) <= slack; };
        if (std::all_of(spaces.begin(), spaces.end(), holds)) best = p;
      }
  return best;
}

double size_of(const CellBox& box) { return glm::length(box.max - box.min); }

}  // namespace

std::optional<glm::dvec3> minimise(const Quadratic& f, std::span<const HalfSpace> spaces, double slack) {
  std::vector<HalfSpace> shuffled(spaces.begin(), spaces.end());
  std::mt19937_64 random(1);
  for (std::size_t i = shuffled.size(); i > 1; --i) std::swap(shuffled[i - 1], shuffled[random() % i]);
  return minimise_on(f, shuffled, slack, {});
}

std::optional<ShrinkGoal> shrink_goal(const ShadowFrustum& frustum, const CellBox& cell, const CellBox& scene) {
  const glm::dvec3 middle = 0.5 * (cell.min + cell.max);
  const auto plane =
      std::max_element(frustum.behind.begin(), frustum.behind.end(),
                       [&](const HalfSpace& a, const HalfSpace& b) { return a.distance(middle) < b.distance(middle); });
  ShrinkGoal goal;
  goal.normal = plane->normal;
  goal.offset = goal.far_offset = plane->offset;
  for (int i = 0; i < 8; ++i) goal.far_offset = std::min(goal.far_offset, glm::dot(goal.normal, corner(scene, i)));
  goal.spread = cross_section(goal.normal, frustum.horizon);
  const auto best = farthest_point(goal.normal, frustum.horizon, 1e-9 * size_of(scene));
  if (!(goal.spread > 0.0) || !best) return std::nullopt;
  goal.best = *best;
  return goal;
}

glm::dvec3 projection_point(std::span<const ShrinkGoal> goals, std::span<const HalfSpace> spaces, const CellBox& cell) {
  const glm::dvec3 middle = 0.5 * (cell.min + cell.max);
  Quadratic f;
  double weights = 0.0;
  for (const ShrinkGoal& goal : goals) {
    const double weight = goal.spread * (goal.offset - goal.far_offset);
    f.h += 2.0 * weight * glm::outerProduct(goal.normal, goal.normal);
    f.c -= 2.0 * weight * glm::dot(goal.normal, goal.best) * goal.normal;
    weights += weight;
  }
  if (!(weights > 0.0)) return middle;
  // Where goals say nothing, near to the middle of the cell.
  constexpr double little = 1e-6;
  f.h += 2.0 * little * weights * glm::dmat3(1.0);
  f.c -= 2.0 * little * weights * middle;
  const std::optional<glm::dvec3> point = minimise(f, spaces, 1e-9 * (1.0 + size_of(cell)));
  return point ? *point : middle;
}

}  // namespace occlod::paper
