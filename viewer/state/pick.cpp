#include "pick.h"

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "explain.h"

namespace occlod::viewer {
namespace {

// Returns the distance along `direction` to either face (Moeller & Trumbore 1997), or nothing.
std::optional<double> meet(const glm::dvec3& origin, const glm::dvec3& direction, const glm::dvec3& a,
                           const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a;
  const glm::dvec3 ac = c - a;
  const glm::dvec3 p = glm::cross(direction, ac);
  const double determinant = glm::dot(ab, p);
  if (determinant == 0.0) return std::nullopt;
  const glm::dvec3 from_a = origin - a;
  const double u = glm::dot(from_a, p) / determinant;
  if (!(u >= 0.0 && u <= 1.0)) return std::nullopt;
  const glm::dvec3 q = glm::cross(from_a, ab);
  const double v = glm::dot(direction, q) / determinant;
  if (!(v >= 0.0 && u + v <= 1.0)) return std::nullopt;
  const double distance = glm::dot(ac, q) / determinant;
  return distance > 0.0 ? std::optional(distance) : std::nullopt;
}

struct ShownTriangles {
  std::span<const glm::vec3> positions;
  std::span<const Triangle> triangles;
};

// Returns the triangles of one object of the frame's first side.
ShownTriangles shown_triangles(const RefinedFrame& frame, std::size_t object) {
  if (!frame.hlod_sides.empty()) {
    const FrontObject& front = frame.hlod_sides[0].front->objects[object];
    return {front.positions, front.triangles};
  }
  return {(*frame.job.objects)[object].mesh->hierarchy->positions(),
          frame.sides[0].refinement.objects[object].triangles};
}

}  // namespace

std::optional<Hit> cast_ray(const RefinedFrame& frame, const Ray& ray, const ClipPlane& clip) {
  if (frame.side_count() == 0) return std::nullopt;
  std::optional<Hit> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < frame.job.objects->size(); ++i) {
    const PlacedObject& object = (*frame.job.objects)[i];
    const glm::dmat4 to_object = glm::inverse(object.object_to_world);
    const glm::dvec3 o(to_object * glm::dvec4(ray.origin, 1.0));
    const glm::dvec3 d(to_object * glm::dvec4(ray.direction, 0.0));
    const auto [positions, triangles] = shown_triangles(frame, i);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto distance = meet(o, d, positions[triangles[t].x], positions[triangles[t].y], positions[triangles[t].z]);
      if (!distance || *distance >= least || is_clipped(clip, ray.origin + *distance * ray.direction)) continue;
      least = *distance;
      nearest = Hit{i, t, ray.origin + least * ray.direction, least};
    }
  }
  return nearest;
}

Pick pick_of(const RefinedFrame& frame, const Hit& hit) {
  const PlacedObject& object = (*frame.job.objects)[hit.object];
  Pick pick;
  pick.object = object.id;
  const auto [positions, triangles] = shown_triangles(frame, hit.object);
  pick.triangle = triangles[hit.triangle];
  for (int k = 0; k < 3; ++k) pick.corners[static_cast<std::size_t>(k)] = positions[pick.triangle[k]];
  pick.point = hit.point;
  if (object.hlod) {
    const HlodFront& front = *frame.hlod_sides[0].front;
    pick.node = front.frame.draws[draw_of(front, hit.object, hit.triangle)].node;
  } else {
    pick.split = born_splits(*object.mesh->hierarchy, {&pick.triangle, 1})[0];
  }
  return pick;
}

}  // namespace occlod::viewer
