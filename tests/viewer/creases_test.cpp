#include "creases.h"

#include <gtest/gtest.h>

#include <cmath>

namespace occlod::viewer {
namespace {

double degrees(std::uint8_t crease) { return crease * crease_unit_deg; }
constexpr double rounding = crease_unit_deg / 2.0 + 1e-4;

const std::vector<glm::vec3> cube_corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                             {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
const std::vector<Triangle> cube_faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                          {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};

// Three edges of 90 degrees meet at each corner; the diagonals are level.
TEST(Creases, CornersOfACube) {
  for (const std::uint8_t crease : find_creases(cube_corners, cube_faces)) EXPECT_NEAR(degrees(crease), 90.0, rounding);
}

// A strip of two rows, folded along its middle: in the profile (-1, -h), (0, 0), (1, -h) the normals differ by twice
// atan(h). The fold has two edges at inner vertices, and one and a border at its ends.
TEST(Creases, FoldUpToItsEnds) {
  for (const double fold_deg : {0.0, 20.0, 60.0, 150.0}) {
    const auto h = static_cast<float>(std::tan(fold_deg / 2.0 * 3.14159265358979 / 180.0));
    std::vector<glm::vec3> positions;
    for (int y = 0; y < 4; ++y)
      for (int x = -1; x <= 1; ++x)
        positions.emplace_back(static_cast<float>(x), static_cast<float>(y), -h * std::abs(static_cast<float>(x)));
    std::vector<Triangle> triangles;
    for (VertexId y = 0; y < 3; ++y)
      for (VertexId x = 0; x < 2; ++x) {
        const VertexId a = 3 * y + x;
        triangles.push_back({a, a + 1, a + 4});
        triangles.push_back({a, a + 4, a + 3});
      }
    const std::vector<std::uint8_t> creases = find_creases(positions, triangles);
    for (std::size_t v = 0; v < creases.size(); ++v)
      EXPECT_NEAR(degrees(creases[v]), v % 3 == 1 ? fold_deg : 0.0, rounding) << v;
    // Wound the other way round here and there, it is the same surface.
    for (std::size_t i = 0; i < triangles.size(); i += 3) std::swap(triangles[i].x, triangles[i].y);
    EXPECT_EQ(find_creases(positions, triangles), creases);
  }
}

// Around the middle the normals are (-1, 0, 2), up, up and (-1, 0, 2): the edges to 2 and 4 bend by atan(1/2), those to
// 1 and 3 are level.
TEST(Creases, BendThroughTheMiddleOfAFan) {
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
  const std::vector<glm::vec3> bent = {{0, 0, 0}, {1, 0, 0.5F}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  EXPECT_NEAR(degrees(find_creases(bent, triangles)[0]), std::atan(0.5) * 57.29578, rounding);
}

// Three faces at an edge: a wall stands on a floor.
TEST(Creases, WallOnAFloor) {
  const std::vector<glm::vec3> positions = {{0, -1, 0}, {0, 1, 0}, {-1, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 3, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const std::vector<std::uint8_t> creases = find_creases(positions, triangles);
  EXPECT_NEAR(degrees(creases[0]), 90.0, rounding);
  EXPECT_NEAR(degrees(creases[1]), 90.0, rounding);
  for (const std::size_t tip : {2U, 3U, 4U, 5U}) EXPECT_EQ(creases[tip], 0);  // of one triangle, or of none
}

}  // namespace
}  // namespace occlod::viewer
