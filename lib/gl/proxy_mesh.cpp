#include <array>
#include <cmath>
#include <numbers>

#include "gl/proxies.h"

namespace occlod::gl {
namespace {

using Corners = std::array<std::uint16_t, 3>;

void add(ProxyMesh& mesh, const Corners& corners) {
  mesh.indices.insert(mesh.indices.end(), corners.begin(), corners.end());
}

// Rounding of vertices must not cut into the exact shape.
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

// An octahedron, each face cut into four, with all 32 planes tangent to the unit ball: the eight middle planes x+y+z =
// sqrt 3 put the middle of an edge at sqrt(3)/2 (1, 1, 0); the planes 5x+y+z = sqrt 27 through two such middles put the
// corners at 3 sqrt(3)/5.
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
    // An odd number of negative axes turns x, y, z clockwise.
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

}  // namespace occlod::gl
