#include "mesh/origin.h"

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "occlod/mesh.h"

namespace occlod {

void move_origin(TriangleMesh& mesh, const glm::dvec3& origin) {
  if (mesh.origin == origin) return;
  const glm::dvec3 shift = mesh.origin - origin;
  for (glm::vec3& p : mesh.positions) p = glm::vec3(glm::dvec3(p) + shift);
  mesh.origin = origin;
}

glm::dmat4 positions_to_world(const glm::dmat4& object_to_world, const glm::dvec3& origin) {
  glm::dmat4 result = object_to_world;
  if (origin != glm::dvec3(0.0)) result[3] = object_to_world * glm::dvec4(origin, 1.0);
  return result;
}

void set_coordinates(TriangleMesh& mesh, std::span<const glm::dvec3> coordinates) {
  OriginChooser chooser;
  const auto is_finite = [](const glm::vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  };
  const auto look_at = [&](const glm::dvec3& p) {
    if (is_finite(glm::vec3(p))) chooser.add(p);
  };
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      if (t[k] < coordinates.size()) look_at(coordinates[t[k]]);
  for (std::size_t v = 0; mesh.triangles.empty() && v < coordinates.size(); ++v) look_at(coordinates[v]);
  const Origin chosen = chooser.choose();
  mesh.origin = chosen.at;
  mesh.positions.clear();
  mesh.positions.reserve(coordinates.size());
  for (const glm::dvec3& p : coordinates) mesh.positions.push_back(chosen.position_of(p));
}

}  // namespace occlod
