#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "hlod/build/cells.h"

namespace occlod::hlod {
namespace {

const OctreeGrid unit_grid(Box{glm::vec3(0.0F), glm::vec3(1.0F)});

// The number of the cell along x that holds x, of 2^depth over twice the extent.
std::uint64_t cell_of(double x, unsigned depth, unsigned thirds) {
  const std::uint64_t code = unit_grid.code({x, 0.0, 0.0}, thirds);
  std::uint64_t cell = 0;
  for (unsigned d = 1; d <= depth; ++d) cell = 2 * cell + (OctreeGrid::octant(code, d) & 1U);
  return cell;
}

TEST(OctreeGrid, CellsHalveTwiceTheExtent) {
  // Cells of depth 3 are a quarter of the extent wide.
  EXPECT_EQ(cell_of(0.0, 3, 0), 0U);
  EXPECT_EQ(cell_of(0.24, 3, 0), 0U);
  EXPECT_EQ(cell_of(0.26, 3, 0), 1U);
  EXPECT_EQ(cell_of(0.99, 3, 0), 3U);
  EXPECT_EQ(cell_of(1.0, 3, 0), 3U);
  EXPECT_EQ(cell_of(7.0, 3, 0), 3U) << "outside counts as on the border";
  EXPECT_EQ(cell_of(-7.0, 3, 0), 0U);
  EXPECT_EQ(cell_of(0.0, 3, 1), 1U);  // 1/3 lies in the second quarter
  EXPECT_EQ(cell_of(0.0, 3, 2), 2U);  // 2/3 in the third
  EXPECT_EQ(cell_of(1.0, 3, 2), 6U);  // 5/3 in the seventh
}

TEST(OctreeGrid, AxesHaveABitEach) {
  EXPECT_EQ(OctreeGrid::octant(unit_grid.code({1.0, 0.0, 0.0}, 0), 2), 1U);
  EXPECT_EQ(OctreeGrid::octant(unit_grid.code({0.0, 1.0, 0.0}, 0), 2), 2U);
  EXPECT_EQ(OctreeGrid::octant(unit_grid.code({0.0, 0.0, 1.0}, 0), 2), 4U);
}

TEST(OctreeGrid, PlanesOfFollowingLevelsStayAThirdOfTheSmallerCellApart) {
  // Exactly: in units of W / (3 * 2^20) a cell of depth d is 3 * 2^(21-d) wide. Cells adapt to density, so those of
  // neighbouring levels may have any two sizes.
  for (unsigned first = 0; first < 3; ++first)
    for (unsigned second = 0; second < 3; ++second) {
      if (first == second) continue;
      for (unsigned d = 1; d <= 12; ++d)
        for (unsigned e = d; e <= 12; ++e) {
          const std::int64_t large = std::int64_t{3} << (21 - d), small = std::int64_t{3} << (21 - e);
          const std::int64_t between = (std::int64_t{second} - std::int64_t{first}) << 20;
          for (std::int64_t plane = 0; plane < 8; ++plane) {
            const std::int64_t rest = (((plane * large + between) % small) + small) % small;
            EXPECT_EQ(std::min(rest, small - rest) * 3, small) << d << " " << e;
          }
        }
    }
}

TEST(OctreeGrid, APointWithoutExtentHasCodes) {
  const OctreeGrid point(Box{glm::vec3(5.0F), glm::vec3(5.0F)});
  EXPECT_EQ(point.code(glm::dvec3(5.0), 0), 0U);
  EXPECT_EQ(point.code(glm::dvec3(6.0), 0), 0U);
}

TEST(OctreeGrid, AnyScaleGivesTheSameCodes) {
  for (const float scale : {1e-37F, 1e37F}) {
    const OctreeGrid scaled(Box{glm::vec3(0.0F), glm::vec3(scale)});
    for (const double x : {0.0, 0.3, 0.7}) {
      const glm::dvec3 p(x, x / 2, x / 3);
      EXPECT_EQ(scaled.code(p * static_cast<double>(scale), 1) >> 9U, unit_grid.code(p, 1) >> 9U);
    }
  }
}

}  // namespace
}  // namespace occlod::hlod
