#include "support/mesh_parts.h"

#include <gtest/gtest.h>

namespace occlod::bench {
namespace {

// A fan of two triangles at one vertex, with a triangle of its own between them.
TEST(MeshParts, AreConnectedThroughVertices) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 2}, {0, -1, 0}, {5, 5, 5}, {6, 5, 5}, {5, 7, 5}};
  mesh.triangles = {{5, 6, 7}, {0, 1, 2}, {3, 4, 0}};
  const MeshParts parts = parts_of(mesh);
  EXPECT_EQ(parts.of_triangle, (std::vector<std::uint32_t>{0, 1, 1}));
  EXPECT_EQ(parts.triangles, (std::vector<std::size_t>{1, 2}));
  ASSERT_EQ(parts.boxes.size(), 2U);
  EXPECT_EQ(parts.boxes[0], (CellBox{{5, 5, 5}, {6, 7, 5}}));
  EXPECT_EQ(parts.boxes[1], (CellBox{{-1, -1, 0}, {1, 1, 2}}));
}

}  // namespace
}  // namespace occlod::bench
