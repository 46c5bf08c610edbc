#include "mesh/triangulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

namespace occlod {
namespace {

struct Cut {
  bool accepted;
  std::vector<Triangle> triangles;
};

Cut cut(const std::vector<glm::vec3>& positions, std::size_t max_steps = std::size_t{1} << 30) {
  std::vector<VertexId> corners(positions.size());
  std::iota(corners.begin(), corners.end(), 0u);
  Cut result{};
  result.accepted = Triangulator(positions, max_steps).append(corners, result.triangles);
  return result;
}

// Signed along `normal`.
double area(const std::vector<glm::vec3>& p, const Triangle& t, const glm::dvec3& normal) {
  const glm::dvec3 a(p[t.x]);
  return 0.5 * glm::dot(glm::cross(glm::dvec3(p[t.y]) - a, glm::dvec3(p[t.z]) - a), normal);
}

// n - 2 triangles, none of which is turned over, and together they have the polygon's area: a triangulation without
// overlap.
void expect_triangulation(const std::vector<glm::vec3>& positions, const glm::dvec3& normal, double expected_area) {
  const Cut result = cut(positions);
  ASSERT_TRUE(result.accepted);
  ASSERT_EQ(result.triangles.size(), positions.size() - 2);
  double sum = 0.0;
  for (const Triangle& t : result.triangles) {
    const double part = area(positions, t, normal);
    EXPECT_GT(part, 0.0);
    sum += part;
  }
  EXPECT_NEAR(sum, expected_area, 1e-6 * expected_area);
}

TEST(Triangulate, ConvexPolygonsAreFans) {
  EXPECT_EQ(cut({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}}).triangles,
            (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

// An L, whose fan from its first corner would lie outside; in every coordinate plane, both ways round.
TEST(Triangulate, ConcavePolygonsAreClippedInAnyPlane) {
  const std::vector<glm::dvec2> shape = {{2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 0}};  // area 3
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {1, -1}) {
      std::vector<glm::vec3> positions;
      for (std::size_t i = 0; i < shape.size(); ++i) {
        const glm::dvec2& p = shape[side > 0 ? i : shape.size() - 1 - i];
        glm::vec3 q(0.0f);
        q[(axis + 1) % 3] = static_cast<float>(p.x);
        q[(axis + 2) % 3] = static_cast<float>(p.y);
        q[axis] = 5.0f;
        positions.push_back(q);
      }
      glm::dvec3 normal(0.0);
      normal[axis] = side;
      expect_triangulation(positions, normal, 3.0);
    }
  }
}

TEST(Triangulate, CombsAndSpiralsAreClipped) {
  std::vector<glm::vec3> comb;  // ten teeth of width 1 and height 9 on a bar of height 1
  for (int tooth = 0; tooth < 10; ++tooth) {
    const auto x = static_cast<float>(2 * tooth);
    comb.insert(comb.end(), {{x, 1, 0}, {x, 10, 0}, {x + 1, 10, 0}, {x + 1, 1, 0}});
  }
  comb.insert(comb.end(), {{19, 0, 0}, {0, 0, 0}});
  std::reverse(comb.begin(), comb.end());  // they went clockwise
  expect_triangulation(comb, {0, 0, 1}, 10 * 9 + 19);
}

// Half of the area of the parallelograms between the origin and each edge.
double shoelace(const std::vector<glm::vec3>& p) {
  double sum = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const glm::dvec3 a(p[i]), b(p[(i + 1) % p.size()]);
    sum += 0.5 * (a.x * b.y - a.y * b.x);
  }
  return sum;
}

// Polygons of rivers and contours: two arms of a spiral, a star with random spikes, and a comb, each with thousands of
// corners of which most are near others. Their triangulations are as exact as those of small ones.
TEST(Triangulate, PolygonsOfThousandsOfCornersAreClipped) {
  for (const int corners : {1000, 8000, 40'000}) {
    std::vector<glm::vec3> spiral, star, comb;
    for (int i = 0; i < corners / 2; ++i) {  // out on one arm
      const double angle = 50.0 * i / corners;
      spiral.emplace_back((1.0 + angle) * std::cos(angle), (1.0 + angle) * std::sin(angle), 0.0);
    }
    for (int i = corners / 2; i-- > 0;) {  // and back on the other
      const double angle = 50.0 * i / corners;
      spiral.emplace_back((0.7 + 0.97 * angle) * std::cos(angle), (0.7 + 0.97 * angle) * std::sin(angle), 0.0);
    }
    if (shoelace(spiral) < 0.0) std::reverse(spiral.begin(), spiral.end());
    expect_triangulation(spiral, {0, 0, 1}, shoelace(spiral));
    std::uint32_t random = 1;
    for (int i = 0; i < corners; ++i) {
      random = 1664525U * random + 1013904223U;
      const double angle = 6.28318530718 * i / corners, radius = 1.0 + (random >> 8U) / 16777216.0;
      star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
    }
    expect_triangulation(star, {0, 0, 1}, shoelace(star));
    for (int i = corners / 4; i-- > 0;) {
      const auto x = static_cast<float>(2 * i);
      comb.insert(comb.end(), {{x + 1, 1, 0}, {x + 1, 10, 0}, {x, 10, 0}, {x, 1, 0}});
    }
    comb.insert(comb.end(), {{0, 0, 0}, {static_cast<float>(corners / 2 - 1), 0, 0}});
    expect_triangulation(comb, {0, 0, 1}, shoelace(comb));
  }
}

// Every corner is in a triangle, also those on straight edges, so that neighbours fit without cracks: a square with
// 100 corners on each side, of which each of the 400 edges is in one triangle.
TEST(Triangulate, KeepsCornersOnStraightEdges) {
  std::vector<glm::vec3> square;
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < 100; ++i) {
      const auto at = static_cast<float>(i);
      square.push_back(side == 0   ? glm::vec3(at, 0, 0)
                       : side == 1 ? glm::vec3(100, at, 0)
                       : side == 2 ? glm::vec3(100 - at, 100, 0)
                                   : glm::vec3(0, 100 - at, 0));
    }
  }
  expect_triangulation(square, {0, 0, 1}, 1e4);
  std::vector<int> uses(square.size(), 0);
  for (const Triangle& t : cut(square).triangles) {
    for (int k = 0; k < 3; ++k) uses[t[k]] += t[(k + 1) % 3] == (t[k] + 1) % square.size();
  }
  EXPECT_EQ(uses, std::vector<int>(square.size(), 1));
}

// Corners on a straight edge must not become triangles without area where others are to be had.
TEST(Triangulate, CornersOnAnEdgeMakeNoFlatTriangles) {
  expect_triangulation({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, {0, 0, 1}, 4.0);
  expect_triangulation({{1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}, {0, 0, 0}},
                       {0, 0, 1}, 4.0);
}

// A square ring cut open by a bridge that is run along twice: outer square 4 x 4, hole 2 x 2.
TEST(Triangulate, HolesWithBridgesAreClipped) {
  expect_triangulation(
      {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}, {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}},
      {0, 0, 1}, 12.0);
}

TEST(Triangulate, HopelessPolygonsBecomeFans) {
  const std::vector<Triangle> fan4 = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(cut({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).triangles, fan4);  // a bow tie: its area vector is zero
  EXPECT_EQ(cut({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}).triangles, fan4);  // on a line
  std::vector<glm::vec3> pentagram;
  for (int i = 0; i < 5; ++i) pentagram.emplace_back(std::cos(2.5132741 * i), std::sin(2.5132741 * i), 0.0);
  EXPECT_EQ(cut(pentagram).triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

// Clipping takes quadratic time at worst: it is refused instead of taking minutes; a convex polygon is not.
TEST(Triangulate, HugeConcavePolygonsAreRefusedAndHugeConvexOnesCut) {
  std::vector<glm::vec3> zigzag;
  constexpr int teeth = 100'000;
  for (int i = 0; i <= teeth; ++i) zigzag.emplace_back(teeth - i, i % 2 == 0 ? 1.0 : 2.0, 0.0);
  zigzag.emplace_back(0.0, -1e6, 0.0);
  zigzag.emplace_back(teeth, -1e6, 0.0);
  const Cut refused = cut(zigzag, std::size_t{1} << 24);
  EXPECT_FALSE(refused.accepted);
  EXPECT_TRUE(refused.triangles.empty());
  std::vector<glm::vec3> parabola;
  for (int i = -2000; i <= 2000; ++i) parabola.emplace_back(i, i * i, 0.0);
  expect_triangulation(parabola, {0, 0, 1}, 4.0 / 3.0 * 2000.0 * 2000.0 * 2000.0 - 2000.0 / 3.0);
}

}  // namespace
}  // namespace occlod
