#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "occlod/build_hierarchy.h"
#include "support/shipped_scenes.h"

namespace occlod {
namespace {

// Whether the segment from a to b meets the triangle (Moeller and Trumbore 1997); the side does not matter.
bool crosses(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
  const glm::dvec3 along = b - a, u = q - p, v = r - p;
  const glm::dvec3 h = glm::cross(along, v);
  const double determinant = glm::dot(u, h);
  if (determinant == 0.0) return false;
  const glm::dvec3 s = a - p, k = glm::cross(s, u);
  const double x = glm::dot(s, h) / determinant, y = glm::dot(along, k) / determinant;
  const double t = glm::dot(v, k) / determinant;
  return x >= 0.0 && y >= 0.0 && x + y <= 1.0 && t >= 0.0 && t <= 1.0;
}

// Triangles of the full mesh that the eye passes through on its way over all keys.
std::size_t count_crossings(const LoadedObject& object, const CameraPath& path) {
  const auto positions = object.hierarchy->positions();
  const auto place = [&](VertexId v) { return glm::dvec3(object.object_to_world * glm::dvec4(positions[v], 1.0)); };
  std::size_t crossings = 0;
  for (const Triangle& t : triangles_of(*object.hierarchy, full_cut(*object.hierarchy)))
    for (std::size_t i = 0; i + 1 < path.keys.size(); ++i)
      crossings += crosses(path.keys[i].eye, path.keys[i + 1].eye, place(t.x), place(t.y), place(t.z)) ? 1U : 0U;
  return crossings;
}

class WalkablePaths : public ::testing::TestWithParam<const char*> {};

// Frames run straight from key to key, so a path that passes no triangle between its keys runs through no wall. Paths
// that jump need not.
TEST_P(WalkablePaths, RunThroughNoWall) {
  OCCLOD_READ_SCENE_OR_SKIP(scene, GetParam());
  for (const LoadedObject& object : test::load_objects(scene))
    for (const auto& [name, path] : scene.description.paths) {
      if (!path.jump) {
        EXPECT_EQ(count_crossings(object, path), 0U) << name;
      }
    }
}

INSTANTIATE_TEST_SUITE_P(All, WalkablePaths,
                         ::testing::Values("sponza", "sibenik", "city", "ww2_city", "hlod_row", "hlod_grid",
                                           "hlod_shelves", "hlod_5m", "hlod_12m"));

}  // namespace
}  // namespace occlod
