// The quadratic programme, beside brute force and CGAL's.
#include "papers/projection_point.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "oracle/random_shapes.h"
#ifdef OCCLOD_HAS_CGAL
#include <CGAL/Gmpq.h>
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#endif

namespace occlod::paper {
namespace {

double value(const Quadratic& f, const glm::dvec3& x) { return 0.5 * glm::dot(x, f.h * x) + glm::dot(f.c, x); }

Quadratic random_quadratic(test::RandomShapes& random) {
  Quadratic f;
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3 n = random.unit();
    f.h += random.in(0.1, 3.0) * glm::outerProduct(n, n);
  }
  f.h += 0.05 * glm::dmat3(1.0);
  f.c = random.in(0.0, 8.0) * random.unit();
  return f;
}

// Around the origin.
std::vector<HalfSpace> random_spaces(test::RandomShapes& random, int count) {
  std::vector<HalfSpace> spaces;
  for (int i = 0; i < count; ++i) spaces.push_back({random.unit(), random.in(0.1, 1.5)});
  return spaces;
}

bool holds(const std::vector<HalfSpace>& spaces, const glm::dvec3& x) {
  for (const HalfSpace& space : spaces)
    if (space.distance(x) > 1e-7) return false;
  return true;
}

// Of the least points without a condition, and on every plane, line and point where planes meet, the best that holds.
double best_by_brute_force(const Quadratic& f, const std::vector<HalfSpace>& spaces) {
  double best = std::numeric_limits<double>::infinity();
  const auto try_point = [&](const glm::dvec3& x) {
    if (holds(spaces, x)) best = std::min(best, value(f, x));
  };
  const glm::dmat3 inverse = glm::inverse(f.h);
  // x = -H^-1 (c + N l) with N'x = d: N' H^-1 N l = -d - N' H^-1 c, padded with ones where there are less than three
  // planes.
  const auto on = [&](const std::vector<std::size_t>& active) {
    glm::dmat3 n(0.0), m(1.0);
    glm::dvec3 right(0.0);
    for (std::size_t i = 0; i < active.size(); ++i) n[static_cast<int>(i)] = spaces[active[i]].normal;
    for (int i = 0; i < static_cast<int>(active.size()); ++i) {
      right[i] = -spaces[active[static_cast<std::size_t>(i)]].offset - glm::dot(n[i], inverse * f.c);
      for (int k = 0; k < static_cast<int>(active.size()); ++k) m[i][k] = glm::dot(n[i], inverse * n[k]);
    }
    if (std::abs(glm::determinant(m)) < 1e-12) return;
    try_point(-(inverse * (f.c + n * (glm::inverse(m) * right))));
  };
  on({});
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    on({i});
    for (std::size_t j = 0; j < i; ++j) {
      on({i, j});
      for (std::size_t k = 0; k < j; ++k) on({i, j, k});
    }
  }
  return best;
}

TEST(QuadraticProgramme, IsTheBestOfAllActiveSets) {
  test::RandomShapes random(1);
  for (int i = 0; i < 400; ++i) {
    const Quadratic f = random_quadratic(random);
    const std::vector<HalfSpace> spaces = random_spaces(random, 1 + i % 16);
    const std::optional<glm::dvec3> x = minimise(f, spaces, 1e-10);
    ASSERT_TRUE(x);
    EXPECT_TRUE(holds(spaces, *x));
    const double best = best_by_brute_force(f, spaces);
    EXPECT_NEAR(value(f, *x), best, 1e-6 * (1.0 + std::abs(best)));
  }
}

#ifdef OCCLOD_HAS_CGAL
TEST(QuadraticProgramme, IsWhatCgalFinds) {
  using Programme = CGAL::Quadratic_program<double>;
  test::RandomShapes random(2);
  for (int i = 0; i < 20; ++i) {
    const Quadratic f = random_quadratic(random);
    const std::vector<HalfSpace> spaces = random_spaces(random, 30);
    Programme programme(CGAL::SMALLER, false, 0, false, 0);
    for (int k = 0; k < static_cast<int>(spaces.size()); ++k) {
      const HalfSpace& space = spaces[static_cast<std::size_t>(k)];
      for (int axis = 0; axis < 3; ++axis) programme.set_a(axis, k, space.normal[axis]);
      programme.set_b(k, space.offset);
    }
    for (int a = 0; a < 3; ++a) {
      programme.set_c(a, f.c[a]);
      for (int b = 0; b <= a; ++b) programme.set_d(a, b, 0.5 * (f.h[a][b] + f.h[b][a]));  // x'Dx / 2
    }
    const auto solution = CGAL::solve_quadratic_program(programme, CGAL::Gmpq());
    ASSERT_TRUE(solution.is_optimal());
    const std::optional<glm::dvec3> x = minimise(f, spaces, 1e-12);
    ASSERT_TRUE(x);
    int axis = 0;
    for (auto v = solution.variable_values_begin(); v != solution.variable_values_end(); ++v, ++axis)
      EXPECT_NEAR((*x)[axis], CGAL::to_double(*v), 1e-6);
  }
}
#endif

// Two half-spaces that exclude each other.
TEST(QuadraticProgramme, HasNoneWhereNothingHolds) {
  Quadratic f;
  f.h = glm::dmat3(1.0);
  const std::vector<HalfSpace> apart = {{{1, 0, 0}, -1.0}, {{-1, 0, 0}, -1.0}};
  EXPECT_FALSE(minimise(f, apart, 1e-9));
}

// A square of 8 x 8 at x = 10, and a cell of 2 x 2 x 2 around the origin, seen from its face x = 1: the planes from the
// square's edges to the far corners of the face x = -1 narrow from 8 to 2 over 11, to 0 over 44/3: the apex of the
// frustum lies at x = 10 - 44/3.
TEST(ShrinkGoal, IsTheApexOfTheFrustum) {
  const CellBox cell{glm::dvec3(-1.0), glm::dvec3(1.0)}, scene{glm::dvec3(-50.0), glm::dvec3(50.0)};
  const ConvexOccluder square = polygon_occluder({{10, -4, -4}, {10, 4, -4}, {10, 4, 4}, {10, -4, 4}});
  const auto frustum = shadow_frustum(square, cell);
  ASSERT_TRUE(frustum);
  EXPECT_EQ(frustum->horizon.size(), 4U);
  const auto goal = shrink_goal(*frustum, cell, scene);
  ASSERT_TRUE(goal);
  EXPECT_NEAR(goal->best.x, 10.0 - 44.0 / 3.0, 1e-9);
  EXPECT_NEAR(goal->offset - goal->far_offset, 40.0, 1e-9);
  EXPECT_NEAR(goal->spread, std::pow(8.0 / (44.0 / 3.0), 2), 1e-9);
  const glm::dvec3 point = projection_point(std::span(&*goal, 1), frustum->horizon, cell);
  EXPECT_NEAR(point.x, goal->best.x, 1e-3);
  EXPECT_NEAR(point.y, 0.0, 1e-3);
  EXPECT_EQ(projection_point({}, frustum->horizon, cell), glm::dvec3(0.0));
}

// Smaller than the cell: the umbra ends.
TEST(ShrinkGoal, IsNoneForWhatIsSmallerThanTheCell) {
  const CellBox cell{glm::dvec3(-1.0), glm::dvec3(1.0)}, scene{glm::dvec3(-50.0), glm::dvec3(50.0)};
  const auto frustum = shadow_frustum(polygon_occluder({{10, -.5, -4}, {10, .5, -4}, {10, .5, 4}, {10, -.5, 4}}), cell);
  ASSERT_TRUE(frustum);
  EXPECT_FALSE(shrink_goal(*frustum, cell, scene));
}

}  // namespace
}  // namespace occlod::paper
