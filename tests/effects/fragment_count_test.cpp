#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "effect_scenes.h"
#include "raster/clip.h"

namespace occlod::test {
namespace {

// Along x, 90 degrees high: at distance 1 the image is 2 units high and 8 / 3 wide.
ObjectView straight_view() { return ObjectView(view_at({1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 90.0), glm::dmat4(1.0)); }

// A square of side 2 in the plane x = 0, whose front is towards the eye.
const std::vector<glm::vec3> square = {{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}};
const std::vector<Triangle> front = {{0, 1, 2}, {0, 2, 3}};
const std::vector<Triangle> back = {{2, 1, 0}, {3, 2, 0}};

// 4 of 16 / 3 square units.
TEST(FragmentCount, IsTheShareOfTheImage) {
  const MeshFragments found = count_fragments(square, front, straight_view(), false, 1);
  EXPECT_NEAR(found.all.layers, 0.75, 1e-6);
  EXPECT_NEAR(found.front.layers, 0.75, 1e-6);
  EXPECT_EQ(found.all.triangles, 2.0);
}

// What shows its back is drawn, but in no occluder; unless it has two sides.
TEST(FragmentCount, TellsFrontsFromBacks) {
  const MeshFragments found = count_fragments(square, back, straight_view(), false, 1);
  EXPECT_NEAR(found.all.layers, 0.75, 1e-6);
  EXPECT_EQ(found.front.layers, 0.0);
  EXPECT_EQ(found.front.triangles, 0.0);
  EXPECT_NEAR(count_fragments(square, back, straight_view(), true, 1).front.layers, 0.75, 1e-6);
}

// Ten times as large it covers the image once, and what is behind the eye covers nothing.
TEST(FragmentCount, EndsAtTheImage) {
  std::vector<glm::vec3> large = square, behind = square;
  for (glm::vec3& p : large) p *= 10.0F;
  for (glm::vec3& p : behind) p.x = 2.0F;
  EXPECT_NEAR(count_fragments(large, front, straight_view(), false, 1).all.layers, 1.0, 1e-6);
  EXPECT_EQ(count_fragments(behind, front, straight_view(), false, 1).all.layers, 0.0);
}

// Every second of equal triangles stands for two.
TEST(FragmentCount, CanTakeSomeForAll) {
  std::vector<Triangle> many;
  for (int i = 0; i < 10; ++i) many.insert(many.end(), front.begin(), front.end());
  const MeshFragments found = count_fragments(square, many, straight_view(), false, 2);
  EXPECT_NEAR(found.all.layers, 7.5, 1e-5);
  EXPECT_EQ(found.all.triangles, 20.0);
}

TEST(FragmentCount, CornersThatAreNoNumbersCoverNothing) {
  std::vector<glm::vec3> broken = square;
  broken[0].y = std::numeric_limits<float>::quiet_NaN();
  const MeshFragments found = count_fragments(broken, front, straight_view(), false, 1);
  EXPECT_EQ(found.all.layers, 0.0);
  EXPECT_EQ(found.all.triangles, 2.0);
}

}  // namespace
}  // namespace occlod::test
