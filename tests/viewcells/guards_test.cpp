// Guards of the hull test and of occluders that no other scene needs: each of these has one right answer, and is wrong
// as soon as the guard is left out.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "hierarchy/motion_cut.h"
#include "occlod/hierarchy/build.h"
#include "support/meshes.h"
#include "viewcells/hull_test.h"

namespace occlod {
namespace {

constexpr CellBox eyes{{-1, -1, -1}, {1, 1, 1}};
constexpr CellBox box{{19, -3, -3}, {21, 3, 3}};

// A sheet over y from `first` to `last` and z from -8 to 8, where x = `at` + `slope` y.
struct Sheet {
  double at = 0.0, slope = 0.0, first = -8.0, last = 8.0;
  float moved = 0.0F;
};

// Sheets that end where the next one begins share the vertices there.
bool hides(const std::vector<Sheet>& sheets) {
  constexpr VertexId cells = 8;
  std::vector<glm::dvec3> positions;
  std::vector<Triangle> triangles;
  std::vector<float> moved;
  const auto add_column = [&](const Sheet& sheet, double y) {
    for (VertexId k = 0; k <= cells; ++k) positions.emplace_back(sheet.at + sheet.slope * y, y, 16.0 * k / cells - 8.0);
  };
  add_column(sheets[0], sheets[0].first);
  for (const Sheet& sheet : sheets)
    for (VertexId i = 1; i <= cells; ++i) {
      const auto left = static_cast<VertexId>(positions.size()) - cells - 1, right = left + cells + 1;
      add_column(sheet, sheet.first + (sheet.last - sheet.first) * i / cells);
      for (VertexId k = 0; k < cells; ++k) {
        triangles.insert(triangles.end(),
                         {{left + k, right + k, right + k + 1}, {left + k, right + k + 1, left + k + 1}});
        moved.insert(moved.end(), {sheet.moved, sheet.moved});
      }
    }
  const CellSurface surface(positions, triangles, moved);
  HullTest test(surface);
  test.set_cell(eyes, 0.0);
  return test.hides(box);
}

// From middle to middle it is crossed at x = 16. But at y = 3 it is at x = 19.6, in the box: the corner (19, 3, z) is
// before it, and every eye sees that.
TEST(HullGuards, WhatReachesIntoTheBoxFurtherOnDoesNotHide) {
  EXPECT_FALSE(hides({{.at = 16.0, .slope = 1.2}}));
  EXPECT_TRUE(hides({{.at = 16.0, .slope = 0.9}}));  // at y = 3 it is at 18.7
}

// From middle to middle it is crossed at x = 4. But at y = -1 it is at x = 0.5, in the cell: an eye at (1, -1, z) is
// behind it, as all of the box is.
TEST(HullGuards, WhatReachesIntoTheCellFurtherOnDoesNotHide) {
  EXPECT_FALSE(hides({{.at = 4.0, .slope = 3.5}}));
  EXPECT_TRUE(hides({{.at = 4.0, .slope = 2.5}}));  // at y = -1 it is at 1.5
}

// The hull reaches to y = 2.1 at x = 10. A sheet that has not moved goes on at y = 2.3 as one that ends at 2.5. If that
// has moved by 0.5, so may the edge of both have; the input may end at y = 2.0, and what is behind shows past it.
TEST(HullGuards, AnEdgeHasMovedAsFarAsTheFartherOfItsTriangles) {
  const Sheet still{.at = 10.0, .last = 2.3}, rest{.at = 10.0, .first = 2.3, .last = 2.5};
  Sheet little = rest, far = rest;
  little.moved = 0.1F;
  far.moved = 0.5F;
  EXPECT_TRUE(hides({still, rest}));
  EXPECT_TRUE(hides({still, little}));
  EXPECT_FALSE(hides({still, far}));
}

// What has moved by m in an object three times as large has moved by 3 m in the world, and no float below that will do.
TEST(OccluderGuards, MotionsAreWorldUnitsAndRoundedUp) {
  const Hierarchy ball = build_hierarchy(test::noisy_sphere(4, 6));
  const MotionCut cut = cut_to_motion(ball, 0.15 / 3.0);
  const RefineObject objects[] = {{&ball, glm::scale(glm::dmat4(1.0), glm::dvec3(3.0))}};
  const CellSurface surface(objects, 0.15, {});
  ASSERT_EQ(surface.triangle_count(), cut.triangles.size());
  std::vector<double> expected, found;
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t) {
    expected.push_back(3.0 * static_cast<double>(cut.moved[t]));
    found.push_back(surface.moved(t));
  }
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_GE(found[i], expected[i]);
    EXPECT_LE(found[i], expected[i] * (1.0 + 1e-6));
  }
  EXPECT_GT(found.back(), 0.1);
}

}  // namespace
}  // namespace occlod
