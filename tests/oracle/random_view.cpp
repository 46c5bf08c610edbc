#include "oracle/random_view.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "occlod/bounds.h"
#include "occlod/generate.h"

namespace occlod::test {
namespace {

TriangleMesh random_soup() {
  RandomShapes random(1);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 60; ++i) {
    const glm::dvec3 center = random.point(1.0);
    for (int k = 0; k < 3; ++k) mesh.positions.emplace_back(center + random.point(0.6));
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  return mesh;
}

glm::dvec3 point_of_surface(const TriangleMesh& mesh, RandomShapes& random) {
  const Triangle& t = mesh.triangles[static_cast<std::size_t>(random.below(static_cast<int>(mesh.triangles.size())))];
  const double a = random.in(0.0, 1.0), b = random.in(0.0, 1.0 - a);
  return a * glm::dvec3(mesh.positions[t.x]) + b * glm::dvec3(mesh.positions[t.y]) +
         (1.0 - a - b) * glm::dvec3(mesh.positions[t.z]);
}

std::vector<glm::dmat4> two_placements(RandomShapes& random) {
  const glm::dmat4 of_bounds = random.placement();
  return {of_bounds, random.placement()};
}

// The mesh where object 1 is.
TriangleMesh placed(const TriangleMesh& mesh, const glm::dmat4& to_world) {
  TriangleMesh result = mesh;
  for (glm::vec3& p : result.positions) p = glm::vec3(to_world * glm::dvec4(p, 1.0));
  return result;
}

std::vector<ObjectView> views_of(const View& view, const std::vector<glm::dmat4>& placements) {
  std::vector<ObjectView> objects;
  for (const glm::dmat4& to_world : placements) objects.emplace_back(view, to_world);
  return objects;
}

}  // namespace

std::string label(SceneKind kind) {
  constexpr std::array<const char*, 5> names{"planet", "pipes", "city", "spheres_behind_wall", "soup"};
  return names[static_cast<std::size_t>(kind)];
}

TriangleMesh scene_mesh(SceneKind kind) {
  switch (kind) {
    case SceneKind::planet:
      return generate("rough-planet", {{"level", 5}});
    case SceneKind::pipes:
      return generate("pipes", {{"pipes", 40}, {"bends", 8}, {"sides", 8}});
    case SceneKind::city:
      return generate("city", {{"blocks", 5}, {"facade_cells", 2}});
    case SceneKind::spheres_behind_wall:
      return generate("spheres-behind-wall", {{"spheres", 24}, {"level", 2}, {"wall_cells", 8}});
    default:
      return random_soup();
  }
}

Camera random_camera(const TriangleMesh& mesh, RandomShapes& random) {
  const Box box = bounding_box(mesh.positions);
  const glm::dvec3 center = glm::dvec3(box.min + box.max) / 2.0, half = glm::dvec3(box.max - box.min) / 2.0;
  const double radius = glm::length(half);
  Camera camera;
  camera.target = point_of_surface(mesh, random);
  switch (random.below(3)) {
    case 0:
      camera.eye = center + random.in(1.2, 4.0) * radius * random.unit();
      break;
    case 1:
      camera.eye = point_of_surface(mesh, random) + random.in(0.01, 0.1) * radius * random.unit();
      break;
    default:
      camera.eye = center + half * random.point(0.8);
      break;
  }
  camera.up = random.unit();
  camera.fov_y_deg = std::exp(random.in(std::log(4.0), std::log(120.0)));
  camera.width = 24 + random.below(100);
  camera.height = 16 + random.below(80);
  camera.near = radius * std::exp(random.in(std::log(1e-4), std::log(1e-2)));
  camera.far = 20.0 * radius;
  if (random.below(3) == 0) camera.principal_point = {random.in(-1.5, 1.5), random.in(-1.5, 1.5)};
  if (random.below(4) == 0) {
    camera.principal_point = glm::dvec2(0.0);
    camera.orthographic_height = radius * std::exp(random.in(std::log(0.03), std::log(4.0)));
    camera.far = 6.0 * radius;
  }
  return camera;
}

RandomView::RandomView(const TriangleMesh& mesh, RandomShapes& random)
    : mesh_(&mesh),
      random_(random),
      placements_(two_placements(random)),
      view_(random_camera(placed(mesh, placements_[1]), random)),
      objects_(views_of(view_, placements_)),
      rays_(view_, placements_, std::array{occluder()}) {}

VisibilityQuery RandomView::next_bound() {
  const glm::dvec2 size(view_.width(), view_.height());
  glm::dvec2 pixel;
  for (const int axis : {0, 1}) pixel[axis] = random_.in(-0.05, 1.05) * size[axis];
  const double depth = random_depth(pixel);
  // World units that cover so many pixels there.
  const double largest = 2.0 * std::max(size.x, size.y);
  const double pixels = std::exp(random_.in(std::log(0.05), random_.below(4) == 0 ? std::log(largest) : std::log(8.0)));
  const bool parallel = view_.is_orthographic();
  const double w = parallel ? 1.0 : depth, extent = pixels * w / view_.focal_length_px();
  const glm::dmat4 to_object = glm::inverse(view_.world_to_clip() * placements_[0]);
  const glm::dvec2 ndc = (pixel / size * 2.0 - 1.0) * glm::dvec2(1.0, -1.0);
  // Clip space's z for a depth: between the planes it is linear in that.
  const double near = view_.camera().near, far = view_.camera().far;
  const double z = (parallel ? 2.0 * depth - far - near : depth * (far + near) - 2.0 * far * near) / (far - near);
  const glm::dvec3 center(to_object * glm::dvec4(ndc * w, z, w));
  const BoundKind kind = random_.kind();
  return random_.bound(kind, glm::vec3(center), extent, 0);
}

double RandomView::random_depth(const glm::dvec2& pixel) {
  const glm::dvec2 last(view_.width() - 1, view_.height() - 1);
  const glm::ivec2 at(glm::clamp(glm::floor(pixel), glm::dvec2(0.0), last));
  const double occluder = rays_.depth(at.x, at.y);
  if (!std::isfinite(occluder)) return view_.camera().near * std::exp(random_.in(0.0, 9.0));
  switch (random_.below(3)) {
    case 0:
      return occluder;
    case 1:
      return occluder * std::exp(random_.in(-0.2, 0.05));
    default:
      return occluder * std::exp(random_.in(0.0, 1.0));
  }
}

}  // namespace occlod::test
