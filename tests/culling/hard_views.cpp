#include "culling/hard_views.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>

#include "occlod/bounds.h"
#include "support/meshes.h"

namespace occlod::test {
namespace {

// In world space.
glm::dvec3 placed(const glm::dmat4& m, const glm::vec3& p) { return glm::dvec3(m * glm::dvec4(p, 1.0)); }

}  // namespace

// Not std::uniform_real_distribution, which may differ between libraries.
double HardViews::between(double low, double high) {
  return low + (high - low) * (static_cast<double>(random_() >> 11U) * 0x1p-53);
}

double HardViews::power_of_ten(double least, double most) { return std::pow(10.0, between(least, most)); }

glm::dvec3 HardViews::direction() {
  glm::dvec3 d;
  do d = {between(-1, 1), between(-1, 1), between(-1, 1)};
  while (!(glm::length(d) > 0.1 && glm::length(d) <= 1.0));
  return glm::normalize(d);
}

TriangleMesh HardViews::mesh() {
  TriangleMesh mesh;
  switch (below(4)) {
    case 0:
      mesh = noisy_sphere(1 + static_cast<int>(below(2)), random_() >> 11U);
      break;
    case 1:
      mesh = grid(5, 5);  // flat: the narrowest cones
      break;
    case 2:
      mesh = octahedron_sphere(2);  // a needle when stretched
      for (glm::vec3& p : mesh.positions) p.x *= 1e6F;
      break;
    default:
      for (int i = 0; i < 40; ++i) {
        TriangleMesh triangle = single_triangle();
        for (glm::vec3& p : triangle.positions) p = glm::vec3(direction() * power_of_ten(-4, 0));
        append(mesh, triangle, glm::vec3(direction()));
      }
  }
  const auto size = static_cast<float>(chance(0.3) ? power_of_ten(-34, 28) : power_of_ten(-2, 2));
  const auto away = static_cast<float>(chance(0.5) ? 0.0 : power_of_ten(0, 6));
  const glm::vec3 offset = size * away * glm::vec3(direction());
  for (glm::vec3& p : mesh.positions) p = size * p + offset;
  return mesh;
}

glm::dmat4 HardViews::transform() {
  glm::dmat4 m(1.0);
  if (chance(0.5)) m = glm::translate(m, direction() * power_of_ten(-3, 9));
  m = glm::rotate(m, between(0.0, 6.28), direction());
  if (chance(0.3)) m = glm::scale(m, glm::dvec3(power_of_ten(-4, 4), power_of_ten(-4, 4), power_of_ten(-4, 4)));
  if (chance(0.3)) m = glm::rotate(m, between(0.0, 6.28), direction());  // after an uneven scale: a shear
  if (chance(0.3)) m = glm::scale(m, glm::dvec3(1.0, 1.0, -1.0));
  return m;
}

Camera HardViews::camera(const TriangleMesh& mesh, const glm::dmat4& object_to_world) {
  const auto vertex = [&] { return placed(object_to_world, mesh.positions[below(mesh.positions.size())]); };
  const Triangle t = mesh.triangles[below(mesh.triangles.size())];
  const glm::dvec3 a = placed(object_to_world, mesh.positions[t.x]), b = placed(object_to_world, mesh.positions[t.y]),
                   c = placed(object_to_world, mesh.positions[t.z]);
  const Box box = bounding_box(mesh.positions);
  const double size = std::max(glm::length(placed(object_to_world, box.max) - placed(object_to_world, box.min)), 1e-60);
  Camera camera;
  switch (below(4)) {
    case 0:
      camera.eye = vertex() + direction() * size * power_of_ten(-1, chance(0.2) ? 12 : 2);
      break;
    case 1:
      camera.eye = glm::mix(vertex(), vertex(), between(0, 1));
      break;
    case 2:
      camera.eye = vertex();
      break;
    default:
      camera.eye =
          (a + b + c) / 3.0 + glm::cross(b - a, c - a) / size * power_of_ten(-12, 0) * (chance(0.5) ? 1.0 : -1.0);
  }
  camera.target = vertex();
  if (chance(0.3) || !(glm::length(camera.target - camera.eye) > 1e-9 * size))
    camera.target = camera.eye + direction() * std::max(size, 1e-6 * glm::length(camera.eye));
  const glm::dvec3 ahead = glm::normalize(camera.target - camera.eye);
  do camera.up = direction();
  while (glm::length(glm::cross(ahead, camera.up)) < 0.01);
  camera.fov_y_deg = chance(0.2) ? 1.0 : chance(0.2) ? 179.0 : between(1.0, 179.0);
  constexpr int sides[] = {1, 16384, 768, 1024};
  camera.width = sides[below(4)];
  camera.height = sides[below(4)];
  const double depth = glm::dot(vertex() - camera.eye, ahead);
  camera.near = chance(0.3) && depth > 0.0 ? depth : size * power_of_ten(-6, 0);
  camera.far = camera.near * (chance(0.3) ? 1e15 : power_of_ten(0.01, 9));
  if (chance(0.2) && depth > camera.near) camera.far = depth;
  if (chance(0.3)) camera.principal_point = {between(-2.0, 2.0), between(-2.0, 2.0)};
  if (chance(0.25) && std::max(size, camera.far) < 1e15) {
    camera.principal_point = glm::dvec2(0.0);
    camera.orthographic_height = size * power_of_ten(-6, 3);
  }
  return camera;
}

}  // namespace occlod::test
