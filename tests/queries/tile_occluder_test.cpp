#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include "refine/occluder.h"

namespace occlod {
namespace {

constexpr double depth = 4.0;

// Looks along -z at the plane z = -4; 1 unit there is 40 pixels, so 5 tiles. The origin is at the middle of 20 x 20
// tiles.
View front_view(bool orthographic = false) {
  Camera camera;
  camera.eye = {0.0, 0.0, 0.0};
  camera.target = {0.0, 0.0, -1.0};
  camera.width = camera.height = 160;
  camera.fov_y_deg = glm::degrees(2.0 * std::atan(2.0 / depth));
  camera.near = 0.1;
  camera.far = 100.0;
  if (orthographic) camera.orthographic_height = 4.0;
  return View(camera);
}

// Squares of the plane, of so many cells, that begin at a corner; faces face the eye.
struct Squares {
  std::vector<glm::vec3> positions;
  std::vector<MovedFace> faces;

  void add(const glm::vec3& first, float size, int cells, float moved = 0.0F) {
    const auto base = static_cast<VertexId>(positions.size());
    const auto row = static_cast<VertexId>(cells + 1);
    for (int y = 0; y <= cells; ++y)
      for (int x = 0; x <= cells; ++x)
        positions.push_back(first + size / static_cast<float>(cells) * glm::vec3(x, y, 0));
    for (VertexId y = 0; y + 1 < row; ++y)
      for (VertexId x = 0; x + 1 < row; ++x) {
        const VertexId a = base + y * row + x;
        faces.push_back({{a, a + 1, a + row + 1}, moved});
        faces.push_back({{a, a + row + 1, a + row}, moved});
      }
  }
  void mark(VertexId v) {
    for (MovedFace& face : faces)
      for (int k = 0; k < 3; ++k)
        if (face.corners[k] == v)
          face.marked = static_cast<std::uint8_t>(face.marked | (1U << static_cast<unsigned>(k)));
  }
};

struct Hiding {
  std::size_t tiles = 0;
  float nearest = 1e9F, farthest = 0.0F;  // distances from the plane of the eye
};

Hiding hide(const Squares& squares, bool two_sided = false, const View& view = front_view(),
            const glm::dmat4& object_to_world = glm::dmat4(1.0)) {
  const ObjectView object(view, object_to_world);
  TileOccluder occluder;
  occluder.begin(view);
  occluder.add(0, squares.faces, squares.positions, object, two_sided);
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;
  occluder.write(0, object, positions, triangles);
  Hiding hiding;
  hiding.tiles = triangles.size() / 2;
  for (const glm::vec3& p : positions) {
    const auto z = static_cast<float>(-(object_to_world * glm::dvec4(p, 1.0)).z);
    hiding.nearest = std::min(hiding.nearest, z);
    hiding.farthest = std::max(hiding.farthest, z);
  }
  return hiding;
}

// Just more than 6 x 6 tiles; in cells that are no tiles.
Squares square(float moved = 0.0F) {
  Squares squares;
  squares.add({-0.61F, -0.61F, -depth}, 1.22F, 7, moved);
  return squares;
}

TEST(TileOccluder, HidesTheTilesThatItCovers) {
  for (const bool orthographic : {false, true}) {
    const Hiding hiding = hide(square(), false, front_view(orthographic));
    EXPECT_EQ(hiding.tiles, 36U);
    EXPECT_GE(hiding.nearest, depth);
    EXPECT_LT(hiding.farthest, depth * 1.0001);
  }
}

// By 1/10 unit, 4 pixels: the outer ring of tiles may be open, and the square so much farther away.
TEST(TileOccluder, IsErodedByTheMotion) {
  const Hiding hiding = hide(square(0.1F));
  EXPECT_EQ(hiding.tiles, 16U);
  EXPECT_GE(hiding.nearest, depth + 0.1);
  EXPECT_LT(hiding.farthest, depth + 0.101);
}

// Through one mark of a mesh that has moved a hole may show, of 4 pixels' radius at most.
TEST(TileOccluder, LeavesMarksOpen) {
  Squares squares;
  squares.add({-0.8F, -0.8F, -depth}, 1.6F, 16, 0.05F);
  const std::size_t whole = hide(squares).tiles;
  EXPECT_EQ(whole, 36U);
  squares.mark(17 * 8 + 8);  // the middle, where four tiles meet
  EXPECT_EQ(hide(squares).tiles, whole - 4);
}

// An edge between two marks may be a slit.
TEST(TileOccluder, LeavesEdgesBetweenMarksOpen) {
  Squares squares;
  squares.add({-0.8F, -0.8F, -depth}, 1.6F, 2, 0.05F);  // edges are 32 pixels long
  squares.mark(4);
  const std::size_t with_one = hide(squares).tiles;
  squares.mark(5);  // on the border, right of it: the edge between both is between tiles
  EXPECT_EQ(hide(squares).tiles, with_one - 2 * 2);
}

// A small sheet in front of a large one opens nothing, although its border may be anywhere.
TEST(TileOccluder, ABorderInFrontDoesNotOpenWhatIsBehind) {
  Squares squares = square(0.02F);
  const std::size_t alone = hide(squares).tiles;
  squares.add({-0.1F, -0.1F, -0.75F * depth}, 0.2F, 1, 0.02F);
  EXPECT_EQ(hide(squares).tiles, alone);
}

TEST(TileOccluder, BacksHideOnlyIfTheyAreSeen) {
  Squares squares = square();
  for (MovedFace& face : squares.faces) std::swap(face.corners.y, face.corners.z);
  EXPECT_EQ(hide(squares).tiles, 0U);
  EXPECT_EQ(hide(squares, true).tiles, 36U);
  // In a mirror what faces the eye in object space still does.
  const glm::dmat4 mirror = glm::scale(glm::dmat4(1.0), {-1.0, 1.0, 1.0});
  EXPECT_EQ(hide(squares, false, front_view(), mirror).tiles, 0U);
  EXPECT_EQ(hide(square(), false, front_view(), mirror).tiles, 36U);
}

// Twice as large in object space is twice as far moved.
TEST(TileOccluder, MotionIsScaledWithItsObject) {
  Squares squares = square(0.05F);
  for (glm::vec3& p : squares.positions) p *= 0.5F;
  EXPECT_EQ(hide(squares, false, front_view(), glm::scale(glm::dmat4(1.0), glm::dvec3(2.0))).tiles, 16U);
}

// Faces that lie on top of each other, of which one is turned over, as a fold leaves them: an edge of four faces is a
// border.
TEST(TileOccluder, EdgesOfManyFacesAreBorders) {
  Squares squares = square();
  const std::size_t count = squares.faces.size();
  for (std::size_t f = 0; f < count; ++f) squares.faces.push_back(squares.faces[f]);
  EXPECT_LT(hide(squares).tiles, 36U);
}

TEST(TileOccluder, WhatReachesTheNearPlaneHidesNothing) {
  Squares squares;
  squares.add({-0.05F, -0.05F, -0.11F}, 0.1F, 1, 0.02F);
  EXPECT_EQ(hide(squares).tiles, 0U);
  squares.faces[0].moved = squares.faces[1].moved = 0.0F;
  EXPECT_GT(hide(squares).tiles, 0U);
}

}  // namespace
}  // namespace occlod
