#include <gtest/gtest.h>

#include "cells/cell_refinement.h"
#include "cells/hull_test.h"
#include "oracle/random_shapes.h"
#include "support/holed_meshes.h"
#include "support/meshes.h"

namespace occlod {
namespace {

CellSurface surface_of(const TriangleMesh& mesh) {
  return {{mesh.positions.begin(), mesh.positions.end()}, mesh.triangles, {}};
}
CellBox around(const glm::dvec3& center, double half) { return {center - half, center + half}; }

// A square of half size 3 at z = 0. From (0, 0, 2) it hides what is within 4.5 of the axis at z = -1.
CellSurface wall() {
  TriangleMesh mesh = test::grid(4, 4);
  for (glm::vec3& p : mesh.positions) p = {6.0F * p.x - 3.0F, 6.0F * p.y - 3.0F, 0.0F};
  return surface_of(mesh);
}

TEST(CellImages, ShowWhatIsBeforeOrBesideAWall) {
  const CellSurface surface = wall();
  CellImages images(surface);
  images.draw(around({0, 0, 2}, 0.5), 0.1);
  EXPECT_TRUE(images.show(around({1, 1, 1}, 0.2)));
  EXPECT_FALSE(images.show(around({1, 1, -1}, 0.2)));
  EXPECT_TRUE(images.show(around({1, 1, -0.1}, 0.2)));  // it reaches to z = 0.1
  EXPECT_TRUE(images.show(around({4.6, 0, -1}, 0.05)));
  EXPECT_FALSE(images.show(around({4.3, 0, -1}, 0.05)));  // to 4.35; there 2.95 / 2 * 3 = 4.425 is hidden
  EXPECT_TRUE(images.show(around({4.4, 0, -1}, 0.15)));   // to 4.55
}

// On all sides, where nothing is.
TEST(CellImages, LookToAllSides) {
  const CellSurface surface = wall();
  CellImages images(surface);
  images.draw(around({0, 0, 2}, 0.5), 0.1);
  for (const glm::dvec3& to : {glm::dvec3(9, 1, 2), glm::dvec3(-9, 2, 3), glm::dvec3(1, 9, 2), glm::dvec3(2, -9, 1),
                               glm::dvec3(1, 2, 9), glm::dvec3(9, 9, 11), glm::dvec3(-9, 9, -1)})
    EXPECT_TRUE(images.show(around(to, 0.1)));
  EXPECT_FALSE(images.show(around({1, -2, -9}, 0.1)));
  EXPECT_TRUE(images.show(around({0, 0, 2}, 0.1)));
}

// From z = 2, what is within 1.5 of the cell reaches to z = 0.
TEST(CellImages, LeaveOutWhatMayBeClipped) {
  const CellSurface surface = wall();
  CellImages images(surface);
  images.draw(around({0, 0, 2}, 0.5), 1.6);
  EXPECT_TRUE(images.show(around({0, 0, -1}, 0.2)));
  images.draw(around({0, 0, 2}, 0.5), 1.4);
  EXPECT_FALSE(images.show(around({0, 0, -1}, 0.2)));
}

// So they change no answer of the hull test; and they know most boxes that it does not call hidden.
TEST(CellImages, ShowNothingThatIsHidden) {
  TriangleMesh mesh = test::sheet_with_windows();
  test::append(mesh, test::noisy_sphere(3, 4), {0, 0, -1.5F});
  const CellSurface surface = surface_of(mesh);
  HullTest hull(surface);
  CellImages images(surface);
  test::RandomShapes random(3);
  int shown = 0, hidden = 0, others = 0;
  for (int cell = 0; cell < 8; ++cell) {
    const CellBox eyes = around(random.point(2.0), random.in(0.0, 0.2));
    hull.set_cell(eyes, 0.01);
    images.draw(eyes, 0.01);
    for (int n = 0; n < 500; ++n) {
      const CellBox box = around(random.point(2.5), random.in(0.01, 0.2));
      const bool is_hidden = hull.hides(box), is_shown = images.show(box);
      EXPECT_FALSE(is_hidden && is_shown);
      ++(is_hidden ? hidden : is_shown ? shown : others);
    }
  }
  EXPECT_GT(hidden, 50);
  EXPECT_GT(shown, 4 * others);
}

}  // namespace
}  // namespace occlod
