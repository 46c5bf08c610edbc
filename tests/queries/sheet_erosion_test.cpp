#include "queries/sheet_erosion.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/meshes.h"

namespace occlod {
namespace {

// The unit square in 20 x 20 cells, seen from 10 above its middle: a length l near the middle is seen as l / 10.
class SheetErosionTest : public ::testing::Test {
 protected:
  SheetErosionTest() : mesh_(test::grid(20, 20)) {
    for (const Triangle& t : mesh_.triangles) faces_.push_back({t, 0.0F});
  }
  std::span<const std::uint8_t> kept() { return erosion_.kept(faces_, mesh_.positions, {0.5F, 0.5F, 10.0F}); }
  [[nodiscard]] float distance_from_rim(const Triangle& t) const {
    float nearest = 1.0F;
    for (int k = 0; k < 3; ++k) {
      const glm::vec3& p = mesh_.positions[t[k]];
      nearest = std::min({nearest, p.x, p.y, 1.0F - p.x, 1.0F - p.y});
    }
    return nearest;
  }

  TriangleMesh mesh_;
  std::vector<SheetFace> faces_;
  SheetErosion erosion_;
};

TEST_F(SheetErosionTest, ExactFacesAreAllKept) {
  const auto all = kept();
  EXPECT_EQ(std::count(all.begin(), all.end(), 1), 800);
}

TEST_F(SheetErosionTest, NothingNearerToTheRimThanItMayHaveMovedIsKept) {
  // The rim may have moved by 0.1, and a face is moved by 0.1 as well: what is kept is 0.2 away. Crossing a cell of
  // 0.05 counts as no less than its triangles' smallest height, 0.05 / sqrt(2), so what is 0.3 away is kept.
  for (SheetFace& face : faces_) face.error = 0.1F;
  const auto result = kept();
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const float distance = distance_from_rim(faces_[f].corners);
    if (distance < 0.19F) {
      EXPECT_EQ(result[f], 0) << distance;
    }
    if (distance > 0.31F) {
      EXPECT_EQ(result[f], 1) << distance;
    }
  }
}

TEST_F(SheetErosionTest, ExactRimIsNoDanger) {
  // Only the middle is uncertain, by 0.1, and it is far from the rim.
  for (SheetFace& face : faces_)
    if (distance_from_rim(face.corners) > 0.3F) face.error = 0.1F;
  const auto all = kept();
  EXPECT_EQ(std::count(all.begin(), all.end(), 1), 800);
}

TEST_F(SheetErosionTest, FoldSeenFromOneSideIsABorder) {
  // Both triangles lie on the same side of their edge as seen from the eye: surface that bends away behind itself.
  mesh_.positions = {{0, 0, 0}, {0, 1, 0}, {1, 0.5F, 0}, {1, 0.5F, -1}};
  mesh_.triangles = {{0, 1, 2}, {0, 1, 3}};
  faces_ = {{mesh_.triangles[0], 0.01F}, {mesh_.triangles[1], 0.01F}};
  const auto result = kept();
  EXPECT_EQ(std::count(result.begin(), result.end(), 1), 0);
}

TEST_F(SheetErosionTest, FaceThatMayReachTheEyeIsDropped) {
  for (SheetFace& face : faces_) face.error = 10.0F;
  const auto result = kept();
  EXPECT_EQ(std::count(result.begin(), result.end(), 1), 0);
}

}  // namespace
}  // namespace occlod
