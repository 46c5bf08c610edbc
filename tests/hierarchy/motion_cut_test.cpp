#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <set>
#include <utility>

#include "occlod/build_hierarchy.h"
#include "splits/surface_motion.h"
#include "support/holed_meshes.h"
#include "support/meshes.h"

namespace occlod {
namespace {

constexpr double everything = 1e9;

// Vertices - edges + faces: 2 for a ball, 0 for a torus, 1 - n for a sheet with n windows.
int euler(std::span<const Triangle> triangles) {
  std::set<VertexId> vertices;
  std::set<std::pair<VertexId, VertexId>> edges;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const VertexId a = t[k], b = t[k == 2 ? 0 : k + 1];
      vertices.insert(a);
      edges.insert(std::minmax(a, b));
    }
  return static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(triangles.size());
}

TEST(MotionCut, WithoutMotionARoughMeshIsTheInput) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(3, 1));
  const MotionCut cut = cut_to_motion(hierarchy, 0.0);
  EXPECT_EQ(cut.triangles.size(), hierarchy.input_triangle_count());
  EXPECT_TRUE(std::all_of(cut.moved.begin(), cut.moved.end(), [](float moved) { return moved == 0.0F; }));
}

// Heights of a plane are zero, and its border slides along itself; only its corners would move.
TEST(MotionCut, APlaneNeedNotMove) {
  const MotionCut cut = cut_to_motion(build_hierarchy(test::grid(16, 16), {.base_triangles = 2}), 1e-4);
  EXPECT_EQ(cut.triangles.size(), 2U);
}

TEST(MotionCut, TopologyStays) {
  const Hierarchy torus = build_hierarchy(test::torus(24, 12), {.base_triangles = 4});
  EXPECT_EQ(euler(cut_to_motion(torus, everything).triangles), 0);
  const Hierarchy ball = build_hierarchy(test::noisy_sphere(3, 1), {.base_triangles = 4});
  EXPECT_EQ(euler(cut_to_motion(ball, everything).triangles), 2);
  EXPECT_LE(cut_to_motion(ball, everything).triangles.size(), 16U);
  const Hierarchy sheet = build_hierarchy(test::sheet_with_windows());
  EXPECT_EQ(euler(cut_to_motion(sheet, everything).triangles), 1 - 36);
  EXPECT_LT(cut_to_motion(sheet, everything).triangles.size(), sheet.input_triangle_count() / 4);
}

}  // namespace
}  // namespace occlod
