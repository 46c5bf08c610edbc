// Hulls, triangles in boxes, facing and scales beside exact rational arithmetic, on random and on nearly degenerate
// numbers. What double precision says may be on the safe side by rounding, and never on the other.
#include <CGAL/Gmpq.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <limits>
#include <vector>

#include "cells/cell_geometry.h"
#include "cells/hull.h"
#include "occlod/cell_builder.h"
#include "oracle/random_shapes.h"

namespace occlod {
namespace {

using Exact = CGAL::Gmpq;
using Exact3 = std::array<Exact, 3>;

Exact3 exact(const glm::dvec3& p) { return {Exact(p.x), Exact(p.y), Exact(p.z)}; }

// Numbers of which many are the same, and many differ by as little as numbers can, or by rounding.
class Numbers {
 public:
  explicit Numbers(std::uint32_t seed) : random_(seed) {}

  double coordinate() {
    if (random_.below(3) == 0) return random_.in(-4.0, 4.0);
    const double whole = random_.below(9) - 4;
    switch (random_.below(4)) {
      case 0:
        return std::nextafter(whole, 10.0);
      case 1:
        return std::nextafter(whole, -10.0);
      case 2:
        return whole + random_.in(-1e-13, 1e-13);
      default:
        return whole;
    }
  }
  glm::dvec3 point() {
    const double x = coordinate(), y = coordinate();
    return {x, y, coordinate()};
  }
  CellBox box() {
    const glm::dvec3 a = point(), b = point();
    return {glm::min(a, b), glm::max(a, b)};
  }
  test::RandomShapes& shapes() { return random_; }

 private:
  test::RandomShapes random_;
};

// A convex polygon, cut exactly: empty once nothing is left, touching counts.
template <std::size_t dimensions>
class Polygon {
 public:
  using Point = std::array<Exact, dimensions>;
  explicit Polygon(std::vector<Point> corners) : corners_(std::move(corners)) {}

  // Keeps where f <= 0; f is linear.
  template <typename Function>
  void keep(const Function& f) {
    std::vector<Point> kept;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Point &p = corners_[i], &q = corners_[(i + 1) % corners_.size()];
      const Exact at_p = f(p), at_q = f(q);
      if (at_p <= 0) kept.push_back(p);
      if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0)) {
        const Exact share = at_p / (at_p - at_q);
        Point between;
        for (std::size_t k = 0; k < dimensions; ++k) between[k] = p[k] + share * (q[k] - p[k]);
        kept.push_back(between);
      }
    }
    corners_ = std::move(kept);
  }
  [[nodiscard]] bool empty() const { return corners_.empty(); }

 private:
  std::vector<Point> corners_;
};

// The hull is the union of all (1 - t) eyes + t what: a + s (b - a) is in it for some s and t of the unit square iff
// six linear inequalities hold.
bool meets_exactly(const CellBox& eyes, const CellBox& what, const glm::dvec3& a, const glm::dvec3& b) {
  Polygon<2> left({{Exact(0), Exact(0)}, {Exact(1), Exact(0)}, {Exact(1), Exact(1)}, {Exact(0), Exact(1)}});
  for (int k = 0; k < 3; ++k) {
    const Exact from(a[k]), step = Exact(b[k]) - from;
    const Exact low(eyes.min[k]), low_step = Exact(what.min[k]) - low, high(eyes.max[k]),
                                  high_step = Exact(what.max[k]) - high;
    left.keep([&](const auto& st) { return Exact(low + st[1] * low_step - from - st[0] * step); });
    left.keep([&](const auto& st) { return Exact(from + st[0] * step - high - st[1] * high_step); });
  }
  return !left.empty();
}

// The growth by which a query of the hull test allows for rounding.
double rounding_of(const CellBox& eyes, const CellBox& what) {
  return 1e-9 * std::max(largest_coordinate(eyes), largest_coordinate(what));
}

TEST(HullExact, NoEdgeThatMeetsItIsMissed) {
  Numbers numbers(1);
  int meets = 0, passes = 0;
  for (int n = 0; n < 20'000; ++n) {
    const CellBox eyes = numbers.box(), what = numbers.box();
    const glm::dvec3 a = numbers.point(), b = numbers.point();
    const double margin = rounding_of(eyes, what);
    const Hull hull(eyes, what);
    if (meets_exactly(eyes, what, a, b)) {
      ++meets;
      EXPECT_TRUE(hull.may_meet(a, b, margin));
    } else {
      ++passes;
    }
    // On the other side it errs by rounding alone.
    if (hull.may_meet(a, b, 0.0)) {
      EXPECT_TRUE(meets_exactly(grown(eyes, margin), grown(what, margin), a, b));
    }
  }
  EXPECT_GT(meets, 2000);
  EXPECT_GT(passes, 2000);
}

// Growing the hull in each axis is growing both boxes.
TEST(HullExact, AMarginGrowsBothBoxes) {
  Numbers numbers(2);
  int meets = 0;
  for (int n = 0; n < 10'000; ++n) {
    const CellBox eyes = numbers.box(), what = numbers.box();
    const glm::dvec3 a = numbers.point(), b = numbers.point();
    const double margin = std::abs(numbers.coordinate()) / 8.0, rounding = rounding_of(eyes, what);
    const Hull hull(eyes, what);
    if (meets_exactly(grown(eyes, margin), grown(what, margin), a, b)) {
      ++meets;
      EXPECT_TRUE(hull.may_meet(a, b, margin + rounding));
    } else {
      EXPECT_FALSE(hull.may_meet(a, b, margin - rounding));
    }
  }
  EXPECT_GT(meets, 1000);
}

bool triangle_meets_exactly(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const CellBox& box) {
  Polygon<3> left({exact(a), exact(b), exact(c)});
  for (std::size_t k = 0; k < 3; ++k) {
    const Exact low(box.min[static_cast<int>(k)]), high(box.max[static_cast<int>(k)]);
    left.keep([&](const Exact3& p) { return Exact(low - p[k]); });
    left.keep([&](const Exact3& p) { return Exact(p[k] - high); });
  }
  return !left.empty();
}

TEST(HullExact, NoTriangleThatMeetsABoxIsMissed) {
  Numbers numbers(3);
  int meets = 0, passes = 0;
  for (int n = 0; n < 20'000; ++n) {
    const CellBox box = numbers.box();
    const glm::dvec3 a = numbers.point(), b = numbers.point(), c = numbers.point();
    const double margin = 1e-9 * largest_coordinate(box);
    if (triangle_meets_exactly(a, b, c, box)) {
      ++meets;
      EXPECT_TRUE(triangle_meets(a, b, c, grown(box, margin)));
    } else {
      ++passes;
    }
    if (triangle_meets(a, b, c, box)) {
      EXPECT_TRUE(triangle_meets_exactly(a, b, c, grown(box, margin)));
    }
  }
  EXPECT_GT(meets, 2000);
  EXPECT_GT(passes, 2000);
}

Exact determinant(const Exact3& x, const Exact3& y, const Exact3& z) {
  return x[0] * (y[1] * z[2] - y[2] * z[1]) - x[1] * (y[0] * z[2] - y[2] * z[0]) + x[2] * (y[0] * z[1] - y[1] * z[0]);
}

Exact3 minus(const Exact3& a, const Exact3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Exact3 placed(const glm::dmat4& m, const glm::vec3& p) {
  Exact3 result;
  for (int row = 0; row < 3; ++row) {
    result[static_cast<std::size_t>(row)] = Exact(m[3][row]);
    for (int k = 0; k < 3; ++k)
      result[static_cast<std::size_t>(row)] += Exact(m[k][row]) * Exact(static_cast<double>(p[k]));
  }
  return result;
}

// All of a box sees only backs iff its corners do: of the front they see the exact sign, turned round by mirrors.
bool faces_away_exactly(const CellBox& cell, const glm::dmat4& m, const std::array<glm::vec3, 3>& face) {
  const Exact3 a = placed(m, face[0]), u = minus(placed(m, face[1]), a), v = minus(placed(m, face[2]), a);
  const auto column = [&](int k) { return exact(glm::dvec3(m[k])); };
  const bool mirrors = determinant(column(0), column(1), column(2)) < 0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 eye((i & 1) != 0 ? cell.max.x : cell.min.x, (i & 2) != 0 ? cell.max.y : cell.min.y,
                         (i & 4) != 0 ? cell.max.z : cell.min.z);
    const Exact front = determinant(u, v, minus(exact(eye), a));
    if (mirrors ? front <= 0 : front >= 0) return false;
  }
  return true;
}

TEST(FacingExact, NoFaceThatAnEyeMaySeeIsLeftOut) {
  Numbers numbers(4);
  const EyeModel eyes;
  int away = 0, close = 0;
  for (int n = 0; n < 20'000; ++n) {
    CellBox cell = numbers.box();
    const glm::dmat4 m = n % 2 == 0 ? glm::dmat4(1.0) : numbers.shapes().placement();
    std::array<glm::vec3, 3> face = {glm::vec3(numbers.point()), glm::vec3(numbers.point()),
                                     glm::vec3(numbers.point())};
    if (n % 3 == 0) {  // an eye in the plane of a face, as near to it as numbers are: on which side is as it happens
      for (glm::vec3& p : face) p = glm::vec3(numbers.shapes().point(4.0));
      const glm::dvec3 a(face[0]), u = glm::dvec3(face[1]) - a, v = glm::dvec3(face[2]) - a;
      cell.min = m * glm::dvec4(a + numbers.shapes().in(-2.0, 2.0) * u + numbers.shapes().in(-2.0, 2.0) * v, 1.0);
      cell.max = cell.min;
    }
    const bool exactly = faces_away_exactly(cell, m, face);
    const bool answer = CellView(cell, eyes, m).faces_away(face[0], face[1], face[2]);
    EXPECT_TRUE(exactly || !answer);
    away += answer ? 1 : 0;
    close += exactly && !answer && n % 3 != 0 ? 1 : 0;
  }
  EXPECT_GT(away, 1000);
  EXPECT_LT(close, away / 10) << "only where rounding decides";
}

// The square of what a unit along an axis of the object covers at a point of the nearest distance d: f^2 |M u|^2 over
// d^2 cos^4 a, or over near^2 cos^2 a where that is less.
TEST(ScaleExact, IsNeverTooSmall) {
  Numbers numbers(5);
  const EyeModel eyes{.focal_length_px = 512.0, .cos_corner_angle = 0.625, .near = 0.125};
  const Exact f(eyes.focal_length_px), c(eyes.cos_corner_angle), near(eyes.near);
  int beside = 0;
  for (int n = 0; n < 20'000; ++n) {
    const CellBox cell = numbers.box();
    const glm::dmat4 m = n % 2 == 0 ? glm::dmat4(1.0) : numbers.shapes().placement();
    const glm::vec3 p(numbers.point());
    const Exact3 at = placed(m, p);
    Exact distance2(0), longest2(0);
    for (int k = 0; k < 3; ++k) {
      const Exact low(cell.min[k]), high(cell.max[k]), x = at[static_cast<std::size_t>(k)];
      const Exact off = x < low ? Exact(low - x) : x > high ? Exact(x - high) : Exact(0);
      distance2 += off * off;
      const Exact3 axis = exact(glm::dvec3(m[k]));
      longest2 = std::max(longest2, Exact(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]));
    }
    const Exact at_near = f * f * longest2 / (near * near * c * c);
    Exact most = at_near;
    if (distance2 > 0) most = std::min(at_near, Exact(f * f * longest2 / (distance2 * c * c * c * c)));
    const Exact scale(static_cast<double>(CellView(cell, eyes, m).largest_scale_px(Sphere{p, 0.0F})));
    EXPECT_GE(scale * scale, most);
    beside += most < at_near ? 1 : 0;
  }
  EXPECT_GT(beside, 2000);
}

}  // namespace
}  // namespace occlod
