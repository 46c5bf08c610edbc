#include "gl/proxies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>
#include <vector>

namespace occlod::gl {
namespace {

// Proxies whose image is this many times the screen are not drawn: far outside, single precision is coarser than the
// proxy's safety margin.
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
  // Checks every point, because a minimum over coordinates ignores NaN.
  if (hull.points.empty() || !std::all_of(hull.points.begin(), hull.points.end(), finite)) return std::nullopt;
  return place_shape(bounding_box(hull.points));
}

// Holds the corners of a placed proxy on the screen, in pixels, and the smallest distance from the near plane,
// unclipped.
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

// Returns the transform to the clip space of a target that extends beyond the image at its right and upper border.
glm::dmat4 target_from_clip(const Screen& screen) {
  const glm::dvec2 share =
      glm::dvec2(screen.width, screen.height) /
      (static_cast<double>(screen.divisor) * glm::dvec2(screen.target_width(), screen.target_height()));
  // The left and lower borders stay fixed: x' + w = share (x + w).
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
  // The near plane lies in front of the eye, so this also rejects bounds around the eye. Written so that NaN counts as
  // visible.
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
  // Unit proxies are symmetric, so one more reflection only flips the winding.
  if (space.mirrored) unit_to_target[2] = -unit_to_target[2];
  return {ProxyDraw{placement->shape, glm::mat4(unit_to_target), static_cast<std::uint32_t>(pixels.x * pixels.y)},
          false};
}

namespace {

using Corners = std::array<std::uint16_t, 3>;

void add(ProxyMesh& mesh, const Corners& corners) {
  mesh.indices.insert(mesh.indices.end(), corners.begin(), corners.end());
}

// Enlarges proxies so that rounding of vertices does not cut into the exact shape.
constexpr double outwards = 1.000001;

ProxyMesh make_box() {
  ProxyMesh mesh;
  const Box cube{glm::vec3(-1.0F), glm::vec3(1.0F)};
  for (int i = 0; i < 8; ++i) mesh.vertices.push_back(corner(cube, i));
  constexpr std::array<Corners, 12> faces{{{0, 4, 6},
                                           {0, 6, 2},
                                           {1, 3, 7},
                                           {1, 7, 5},
                                           {0, 1, 5},
                                           {0, 5, 4},
                                           {2, 6, 7},
                                           {2, 7, 3},
                                           {0, 2, 3},
                                           {0, 3, 1},
                                           {4, 5, 7},
                                           {4, 7, 6}}};
  for (const Corners& face : faces) add(mesh, face);
  return mesh;
}

// Makes an octahedron with each face cut into four and all 32 planes tangent to the unit ball: the eight middle planes
// x+y+z = sqrt 3 put the midpoint of an edge at sqrt(3)/2 (1, 1, 0); the planes 5x+y+z = sqrt 27 through two such
// midpoints put the corners at 3 sqrt(3)/5.
ProxyMesh make_sphere() {
  ProxyMesh mesh;
  const auto corner_radius = static_cast<float>(outwards * 3.0 * std::numbers::sqrt3 / 5.0);
  const auto middle = static_cast<float>(outwards * std::numbers::sqrt3 / 2.0);
  for (const float sign : {1.0F, -1.0F})  // 0-2: +x, +y, +z; 3-5: -x, -y, -z
    for (int axis = 0; axis < 3; ++axis) {
      glm::vec3 vertex(0.0F);
      vertex[axis] = sign * corner_radius;
      mesh.vertices.push_back(vertex);
    }
  const auto middle_of = [&](int a, int b) {
    glm::vec3 vertex(0.0F);
    vertex[a % 3] = a < 3 ? middle : -middle;
    vertex[b % 3] = b < 3 ? middle : -middle;
    for (std::size_t i = 6; i < mesh.vertices.size(); ++i)
      if (mesh.vertices[i] == vertex) return static_cast<std::uint16_t>(i);
    mesh.vertices.push_back(vertex);
    return static_cast<std::uint16_t>(mesh.vertices.size() - 1);
  };
  for (int octant = 0; octant < 8; ++octant) {
    const std::array<int, 3> sign{octant & 1, (octant >> 1) & 1, (octant >> 2) & 1};
    const int a = 3 * sign[0];
    // An odd number of negative axes turns the order x, y, z clockwise.
    const bool turned = (sign[0] + sign[1] + sign[2]) % 2 == 1;
    const int b = turned ? 2 + 3 * sign[2] : 1 + 3 * sign[1];
    const int c = turned ? 1 + 3 * sign[1] : 2 + 3 * sign[2];
    const std::uint16_t ab = middle_of(a, b);
    const std::uint16_t bc = middle_of(b, c);
    const std::uint16_t ca = middle_of(c, a);
    add(mesh, {static_cast<std::uint16_t>(a), ab, ca});
    add(mesh, {static_cast<std::uint16_t>(b), bc, ab});
    add(mesh, {static_cast<std::uint16_t>(c), ca, bc});
    add(mesh, {ab, bc, ca});
  }
  return mesh;
}

ProxyMesh make_cylinder() {
  constexpr std::uint16_t sides = 16;
  ProxyMesh mesh;
  const double radius = outwards / std::cos(std::numbers::pi / sides);
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    const auto x = static_cast<float>(radius * std::cos(angle));
    const auto y = static_cast<float>(radius * std::sin(angle));
    mesh.vertices.emplace_back(x, y, -1.0F);
    mesh.vertices.emplace_back(x, y, 1.0F);
  }
  mesh.vertices.emplace_back(0.0F, 0.0F, -1.0F);
  mesh.vertices.emplace_back(0.0F, 0.0F, 1.0F);
  constexpr std::uint16_t low_center = 2 * sides;
  constexpr std::uint16_t high_center = 2 * sides + 1;
  for (int i = 0; i < sides; ++i) {
    const auto low = static_cast<std::uint16_t>(2 * i);
    const auto high = static_cast<std::uint16_t>(low + 1);
    const auto next_low = static_cast<std::uint16_t>(2 * ((i + 1) % sides));
    const auto next_high = static_cast<std::uint16_t>(next_low + 1);
    add(mesh, {low, next_low, next_high});
    add(mesh, {low, next_high, high});
    add(mesh, {low_center, next_low, low});
    add(mesh, {high_center, high, next_high});
  }
  return mesh;
}

}  // namespace

const ProxyMesh& unit_proxy(ProxyShape shape) {
  static const std::array<ProxyMesh, proxy_shape_count> meshes{make_sphere(), make_box(), make_cylinder()};
  return meshes[static_cast<std::size_t>(shape)];
}

ProxyBuffer::ProxyBuffer(const Functions& gl) : array_(gl), vertices_(gl), indices_(gl) {
  std::vector<glm::vec3> vertices;
  std::vector<std::uint16_t> indices;
  for (std::size_t i = 0; i < proxy_shape_count; ++i) {
    const ProxyMesh& proxy = unit_proxy(static_cast<ProxyShape>(i));
    parts_[i] = {static_cast<GLsizei>(proxy.indices.size()), indices.size() * sizeof(std::uint16_t)};
    const auto base = static_cast<std::uint16_t>(vertices.size());
    for (const std::uint16_t index : proxy.indices) indices.push_back(static_cast<std::uint16_t>(base + index));
    vertices.insert(vertices.end(), proxy.vertices.begin(), proxy.vertices.end());
  }
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl.EnableVertexAttribArray(0);
  gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  fill(gl, GL_ARRAY_BUFFER, std::span<const glm::vec3>(vertices), GL_STATIC_DRAW);
  fill(gl, GL_ELEMENT_ARRAY_BUFFER, std::span<const std::uint16_t>(indices), GL_STATIC_DRAW);
}

}  // namespace occlod::gl
