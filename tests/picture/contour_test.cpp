// At a contour rounding can make the back face the owner of a pixel that the front face covers.
#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "picture/quads.h"

namespace occlod {
namespace {

using test::front_view;
using test::pixel;

constexpr std::uint32_t back = 1;

// Item 0 faces the viewer at z = -4, right of and below the diagonal of the square of columns 30 to 69 and rows 20 to
// 59. Item 1 shares its right edge and lies behind it: the normal is (8, 0, -16), away from the eye.
struct Fold {
  explicit Fold(bool mirrored) {
    if (!mirrored) return;
    for (glm::vec3& p : positions) p.x = -p.x;
    for (Triangle& t : triangles) std::swap(t.y, t.z);
    object_to_world[0][0] = -1.0;
  }
  [[nodiscard]] DrawObject object() const { return {positions, {}, triangles, object_to_world}; }

  std::vector<glm::vec3> positions = {{-2, -2, -4}, {2, -2, -4}, {2, 2, -4}, {-2, 0, -6}};
  std::vector<Triangle> triangles = {{0, 1, 2}, {2, 1, 3}};
  glm::dmat4 object_to_world{1.0};
};

// With the back face as the owner of these columns of row 45, all inside the front face.
Image shaded(const Fold& fold, std::initializer_list<int> columns) {
  const std::array<DrawObject, 1> objects = {fold.object()};
  ItemBuffer items;
  draw_items(items, objects, front_view());
  for (const int x : columns) {
    std::uint32_t& owner = items.items[static_cast<std::size_t>(100 * 45 + x)];
    EXPECT_EQ(owner, 0U) << x;
    owner = back;
  }
  return shade(items, objects, front_view(), {.wire = false});
}

TEST(Contour, SinglePixelOfABackFaceIsShadedAsTheFrontFaceBesideIt) {
  for (const bool mirrored : {false, true}) {
    const Fold fold(mirrored);
    const Image expected = shaded(fold, {});
    EXPECT_EQ(shaded(fold, {68}).pixels, expected.pixels) << mirrored;
    EXPECT_EQ(shaded(fold, {60, 68}).pixels, expected.pixels) << mirrored;
  }
}

// Lit as a back face is: by its own normal, turned to the eye.
TEST(Contour, BackFaceThatIsSeenKeepsItsShade) {
  const Fold fold(false);
  const Image expected = shaded(fold, {});
  const Image found = shaded(fold, {67, 68});
  for (int x = 0; x < 100; ++x) EXPECT_EQ(pixel(found, x, 45) != pixel(expected, x, 45), x == 67 || x == 68) << x;
}

}  // namespace
}  // namespace occlod
