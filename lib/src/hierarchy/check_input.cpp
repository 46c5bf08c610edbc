#include "check_input.h"

#include <cmath>
#include <string>

#include "math/inverse_power_of_two.h"
#include "occlod/core/error.h"
#include "position_ids.h"

namespace occlod {
namespace {

constexpr const char* clean_it = "run clean() on the mesh first";

}  // namespace

void check_input(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw Error({"mesh", "", "has no triangles", "give a mesh with at least one"});
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::vec3& p = mesh.positions[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw Error({"mesh", "vertex " + std::to_string(v), "is not finite", clean_it});
    if (largest_coordinate(p) > farthest_coordinate)
      throw Error(
          {"mesh", "vertex " + std::to_string(v), "is farther than 1.5e37 from the origin", "scale the mesh down"});
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    const std::size_t n = mesh.vertex_count();
    if (corners.x >= n || corners.y >= n || corners.z >= n || corners.x == corners.y || corners.y == corners.z ||
        corners.z == corners.x)
      throw Error({"mesh", "triangle " + std::to_string(t), "repeats a corner or refers to a vertex that is not there",
                   clean_it});
  }
}

void check_welded(const TriangleMesh& mesh) {
  PositionIds ids(mesh.vertex_count());
  for (VertexId v = 0; v < mesh.vertex_count(); ++v)
    if (const std::uint32_t id = ids.add(mesh.positions[v]); id != v)
      throw Error(
          {"mesh", "vertex " + std::to_string(v), "has the position of vertex " + std::to_string(id), clean_it});
}

}  // namespace occlod
