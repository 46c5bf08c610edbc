#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>

#include "hlod/tiles/tile_tree.h"

namespace occlod::tiles {
namespace {

void expect_column(const glm::dmat4& matrix, int column, const glm::dvec3& expected, double slack) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(matrix[column][k], expected[k], slack) << column << ", " << k;
}

// Where the axes of the Earth cross the ellipsoid: half axes of 6378137 and 6356752.314245179 m (WGS84).
TEST(Geodetic, AxesOfTheEarth) {
  const glm::dmat4 gulf = east_north_up({0.0, 0.0, 0.0});
  EXPECT_EQ(gulf, glm::dmat4({0, 1, 0, 0}, {0, 0, 1, 0}, {1, 0, 0, 0}, {6378137.0, 0, 0, 1}));
  const glm::dmat4 indian_ocean = east_north_up({90.0, 0.0, 100.0});
  EXPECT_EQ(indian_ocean, glm::dmat4({-1, 0, 0, 0}, {0, 0, 1, 0}, {0, 1, 0, 0}, {0, 6378237.0, 0, 1}));
  const glm::dmat4 date_line = east_north_up({-180.0, 0.0, 0.0});
  expect_column(date_line, 0, {0, -1, 0}, 0.0);
  expect_column(date_line, 3, {-6378137.0, 0, 0}, 0.0);
  const glm::dmat4 north_pole = east_north_up({0.0, 90.0, 7.0});
  expect_column(north_pole, 0, {0, 1, 0}, 0.0);
  expect_column(north_pole, 1, {-1, 0, 0}, 0.0);
  expect_column(north_pole, 3, {0, 0, 6356759.314245179}, 2e-9);
  expect_column(east_north_up({0.0, -90.0, 0.0}), 2, {0, 0, -1}, 0.0);
}

// East and north are the derivatives of the place by longitude and latitude, and up by height.
TEST(Geodetic, AxesPointWhereThePlaceGoes) {
  for (const double longitude : {-170.0, -11.5, 0.25, 44.0, 123.0})
    for (const double latitude : {-85.0, -48.1, 0.5, 60.0}) {
      const GeodeticOrigin here{longitude, latitude, 300.0};
      const glm::dmat4 matrix = east_north_up(here);
      const auto place = [](const GeodeticOrigin& at) { return glm::dvec3(east_north_up(at)[3]); };
      const double step = 1e-5;
      expect_column(matrix, 0, glm::normalize(place({longitude + step, latitude, 300.0}) - place(here)), 1e-6);
      expect_column(matrix, 1, glm::normalize(place({longitude, latitude + step, 300.0}) - place(here)), 1e-6);
      expect_column(matrix, 2, place({longitude, latitude, 301.0}) - place(here), 2e-9);
      EXPECT_NEAR(glm::determinant(matrix), 1.0, 1e-12);
    }
}

}  // namespace
}  // namespace occlod::tiles
