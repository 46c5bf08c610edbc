#include "gl/proxies.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>
#include <limits>

namespace occlod::gl {
namespace {

// Proxies whose image is so many times the screen are not drawn: far outside, single precision is coarser than
// the growth allows.
constexpr double largest_image = 8.0;

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::optional<Placement> place_shape(const Sphere& sphere) {
  if (!finite(sphere.center) || !std::isfinite(sphere.radius) || !(sphere.radius >= 0.0F)) return std::nullopt;
  return Placement{ProxyShape::sphere, sphere.center, glm::dmat3(1.0), glm::dvec3(sphere.radius)};
}

std::optional<Placement> place_shape(const Box& box) { return place_box(box); }

std::optional<Placement> place_shape(const Cylinder& cylinder) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(cylinder.axis));
  if (!finite(cylinder.center) || !finite(glm::vec3(axis)) || !std::isfinite(cylinder.radius) ||
      !(cylinder.radius >= 0.0F) || !std::isfinite(cylinder.t_min) || !std::isfinite(cylinder.t_max) ||
      !(cylinder.t_min <= cylinder.t_max))
    return std::nullopt;
  // Any vector that is not parallel to the axis spans the plane with it.
  const glm::dvec3 other = std::abs(axis.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(axis, other));
  const double t_min = cylinder.t_min;
  const double t_max = cylinder.t_max;
  return Placement{ProxyShape::cylinder,
                   glm::dvec3(cylinder.center) + (t_min + t_max) / 2.0 * axis,
                   glm::dmat3(u, glm::cross(axis, u), axis),
                   {cylinder.radius, cylinder.radius, (t_max - t_min) / 2.0}};
}

std::optional<Placement> place_shape(const PointHull& hull) {
  // Checked one by one: a minimum over coordinates passes over NaN.
  if (hull.points.empty() || !std::all_of(hull.points.begin(), hull.points.end(), finite)) return std::nullopt;
  return place_shape(bounding_box(hull.points));
}

// Where the corners of a placed proxy are on the screen, in pixels, and how far before the near plane, unclipped.
struct Image {
  glm::dvec2 min{std::numeric_limits<double>::infinity()};
  glm::dvec2 max{-std::numeric_limits<double>::infinity()};
  double before_near = std::numeric_limits<double>::infinity();
};

Image project(const Screen& screen, const glm::dmat4& unit_to_clip, ProxyShape shape) {
  const glm::dvec2 half_size = glm::dvec2(screen.width, screen.height) / 2.0;
  Image image;
  for (const glm::vec3& vertex : unit_proxy(shape).vertices) {
    const glm::dvec4 clip = unit_to_clip * glm::dvec4(vertex, 1.0);
    const glm::dvec2 pixel = (glm::dvec2(clip) / clip.w + 1.0) * half_size;
    image.min = glm::min(image.min, pixel);
    image.max = glm::max(image.max, pixel);
    image.before_near = std::min(image.before_near, clip.z + clip.w);
  }
  return image;
}

glm::dmat4 unit_to_object(const Placement& placement) {
  glm::dmat4 matrix(1.0);
  for (int i = 0; i < 3; ++i) matrix[i] = glm::dvec4(placement.half[i] * placement.directions[i], 0.0);
  matrix[3] = glm::dvec4(placement.center, 1.0);
  return matrix;
}

// To the clip space of a target that reaches beyond the image at its right and upper border.
glm::dmat4 target_from_clip(const Screen& screen) {
  const glm::dvec2 share =
      glm::dvec2(screen.width, screen.height) /
      (static_cast<double>(screen.divisor) * glm::dvec2(screen.target_width(), screen.target_height()));
  // The left and lower borders stay: x' + w = share (x + w).
  glm::dmat4 matrix(1.0);
  matrix[0].x = share.x;
  matrix[1].y = share.y;
  matrix[3].x = share.x - 1.0;
  matrix[3].y = share.y - 1.0;
  return matrix;
}

bool all_finite(const glm::mat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(m[column][row])) return false;
  return true;
}

}  // namespace

std::optional<Placement> place(const VisibilityQuery& query) {
  return std::visit([](const auto& shape) { return place_shape(shape); }, query.shape);
}

QueryPlan plan_query(const Screen& screen, const ProxySpace& space, const VisibilityQuery& query) {
  const std::optional<Placement> placement = place(query);
  if (!placement) return {std::nullopt, true};
  const glm::dmat4 unit_to_clip = space.object_to_clip * unit_to_object(grown(*placement, screen, space));
  const Image image = project(screen, unit_to_clip, placement->shape);
  // The near plane lies in front of the eye, so this holds back bounds around the eye too. Written so that NaN counts
  // as visible.
  if (!(image.before_near > 0.0) || !all_finite(glm::mat4(unit_to_clip))) return {std::nullopt, true};
  const glm::dvec2 size(screen.width, screen.height);
  if (glm::any(glm::lessThan(image.max, glm::dvec2(0.0))) || glm::any(glm::greaterThan(image.min, size)))
    return {std::nullopt, false};
  const glm::dvec2 screens = (image.max - image.min) / size;
  if (glm::all(glm::greaterThanEqual(screens, glm::dvec2(1.0))) ||
      glm::any(glm::greaterThan(screens, glm::dvec2(largest_image))))
    return {std::nullopt, true};
  const glm::dvec2 pixels = glm::ceil(glm::min(image.max, size)) - glm::floor(glm::max(image.min, glm::dvec2(0.0)));
  glm::dmat4 unit_to_target = screen.divisor == 1 ? unit_to_clip : target_from_clip(screen) * unit_to_clip;
  // Unit proxies are their own mirror images, so one more reflection turns the winding and nothing else.
  if (space.mirrored) unit_to_target[2] = -unit_to_target[2];
  return {ProxyDraw{placement->shape, glm::mat4(unit_to_target), static_cast<std::uint32_t>(pixels.x * pixels.y)},
          false};
}

}  // namespace occlod::gl
