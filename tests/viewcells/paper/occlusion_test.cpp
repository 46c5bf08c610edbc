// Cones, shadow frusta, cull maps and shrunk occluders: what they hide is hidden from every eye.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "oracle/random_shapes.h"
#include "papers/back_faces.h"
#include "papers/cull_map.h"
#include "papers/shrunk_occlusion.h"

namespace occlod::paper {
namespace {

constexpr CellBox cell{{-1, -1, -1}, {1, 1, 1}};
constexpr CellBox scene{{-60, -60, -2}, {60, 60, 40}};

glm::dvec3 point_in(const CellBox& box, test::RandomShapes& random) {
  return {random.in(box.min.x, box.max.x), random.in(box.min.y, box.max.y), random.in(box.min.z, box.max.z)};
}

// Whether the segment meets the box: by slabs.
bool meets(const CellBox& box, const glm::dvec3& a, const glm::dvec3& b) {
  double from = 0.0, to = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = b[axis] - a[axis];
    if (std::abs(along) < 1e-300) {
      if (a[axis] < box.min[axis] || a[axis] > box.max[axis]) return false;
      continue;
    }
    const double low = (box.min[axis] - a[axis]) / along, high = (box.max[axis] - a[axis]) / along;
    from = std::max(from, std::min(low, high));
    to = std::min(to, std::max(low, high));
  }
  return from <= to;
}

bool is_stopped(const std::vector<CellBox>& boxes, const glm::dvec3& eye, const glm::dvec3& point) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const CellBox& box) { return meets(box, eye, point); });
}

CellBox around(const glm::dvec3& middle, const glm::dvec3& half) { return {middle - half, middle + half}; }

// Boxes on the ground, none at the cell.
std::vector<CellBox> random_houses(test::RandomShapes& random, int count) {
  std::vector<CellBox> houses;
  while (static_cast<int>(houses.size()) < count) {
    const glm::dvec3 middle(random.in(-50.0, 50.0), random.in(-50.0, 50.0), 0.0);
    if (std::max(std::abs(middle.x), std::abs(middle.y)) < 8.0) continue;
    const double height = random.in(5.0, 30.0);
    houses.push_back(
        {middle - glm::dvec3(random.in(1.0, 6.0), random.in(1.0, 6.0), 2.0), middle + glm::dvec3(2, 2, height)});
  }
  return houses;
}

CellBox random_box(test::RandomShapes& random) {
  return around({random.in(-55.0, 55.0), random.in(-55.0, 55.0), random.in(0.0, 20.0)},
                {random.in(0.1, 2.0), random.in(0.1, 2.0), random.in(0.1, 2.0)});
}

TEST(BoundingCone, OfTwoVectorsIsHalfOfTheirAngle) {
  const std::vector<glm::dvec3> two = {{1, 0, 0}, {0, 1, 0}};
  const auto cone = bounding_cone(two);
  ASSERT_TRUE(cone);
  EXPECT_NEAR(cone->angle, std::numbers::pi / 4.0, 1e-12);
  EXPECT_NEAR(glm::distance(cone->axis, glm::normalize(glm::dvec3(1, 1, 0))), 0.0, 1e-12);
  EXPECT_FALSE(bounding_cone(std::vector<glm::dvec3>{{1, 0, 0}, {-1, 0, 0}}));
}

TEST(BoundingCone, HoldsAllAndIsNearlyTheSmallest) {
  test::RandomShapes random(1);
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 axis = random.unit();
    const double limit = random.in(0.05, 1.2);
    std::vector<glm::dvec3> vectors;
    while (vectors.size() < 40) {
      const glm::dvec3 v = random.unit();
      if (std::acos(std::clamp(glm::dot(v, axis), -1.0, 1.0)) <= limit) vectors.push_back(v);
      if (vectors.empty() && limit < 0.2) vectors.push_back(axis);
      if (limit < 0.3 && !vectors.empty())
        vectors.push_back(glm::normalize(axis + 0.9 * std::tan(limit) * random.in(0.0, 1.0) * random.unit()));
    }
    const auto cone = bounding_cone(vectors);
    ASSERT_TRUE(cone);
    for (const glm::dvec3& v : vectors) EXPECT_GE(glm::dot(v, cone->axis), std::cos(cone->angle) - 1e-9);
    EXPECT_LE(cone->angle, 1.35 * limit);
  }
}

// A square that faces +x, seen from x in [-1, 1]: beyond, it turns its back; before, its front.
TEST(FacingFromACell, IsDecidedWhereThePlaneIsBesideTheCell) {
  const Cone normals{{1, 0, 0}, 0.0};
  EXPECT_EQ(facing(cell, {{9, -1, -1}, {9, 1, 1}}, normals), Facing::back);
  EXPECT_EQ(facing(cell, {{-9, -1, -1}, {-9, 1, 1}}, normals), Facing::front);
  EXPECT_EQ(facing(cell, {{0.5, 9, -1}, {0.5, 11, 1}}, normals), Facing::mixed);
  EXPECT_EQ(facing(cell, {{-1, -1, -1}, {1, 1, 1}}, normals), Facing::mixed);
}

TEST(FacingFromACell, HoldsForEveryEyePointAndNormal) {
  test::RandomShapes random(2);
  int backs = 0, fronts = 0;
  for (int i = 0; i < 3000; ++i) {
    const CellBox box = around(random.in(2.0, 12.0) * random.unit(), glm::dvec3(random.in(0.0, 1.0)));
    const Cone normals{random.unit(), random.in(0.0, 0.5)};
    const Facing answer = facing(cell, box, normals);
    if (answer == Facing::mixed) continue;
    ++(answer == Facing::back ? backs : fronts);
    for (int k = 0; k < 20; ++k) {
      const glm::dvec3 side = glm::normalize(glm::cross(normals.axis, random.unit()));
      const double angle = random.in(0.0, normals.angle);
      const glm::dvec3 normal = std::cos(angle) * normals.axis + std::sin(angle) * side;
      const double towards = glm::dot(normal, point_in(cell, random) - point_in(box, random));
      EXPECT_TRUE(answer == Facing::back ? towards < 1e-9 : towards > -1e-9);
    }
  }
  EXPECT_GT(backs, 300);
  EXPECT_GT(fronts, 300);
}

// Closed form: a square that holds the section of the hull hides the box, and one that does not, does not. From y = 1
// at x = -1 to y = 3 at x = 19 the hull has y = 2.1 at x = 10.
TEST(ShadowFrustum, OfASquareIsItsUmbra) {
  const CellBox box{{19, -3, -3}, {21, 3, 3}};
  for (const double half : {2.05, 2.35, 2.45}) {
    const auto frustum = shadow_frustum(
        polygon_occluder({{10, -half, -half}, {10, half, -half}, {10, half, half}, {10, -half, half}}), cell);
    ASSERT_TRUE(frustum);
    // The widest segment ends at (21, 3): it begins at (-1, 1) or (1, 1), and has y = 1 + 2 * 11 / 22 = 2 or less than
    // that of the one to (19, 3): 1 + 2 * 11 / 20 = 2.1.
    EXPECT_EQ(holds(*frustum, box), half > 2.1);
  }
}

// Whether rounding may decide.
bool is_at_border(const ShadowFrustum& frustum, const glm::dvec3& p) {
  const auto is_near = [&](const HalfSpace& space) { return std::abs(space.distance(p)) < 1e-6; };
  return std::any_of(frustum.horizon.begin(), frustum.horizon.end(), is_near) ||
         std::any_of(frustum.behind.begin(), frustum.behind.end(), is_near);
}

TEST(ShadowFrustum, OfABoxIsAllThatItHides) {
  test::RandomShapes random(3);
  int hidden = 0, visible = 0;
  for (int i = 0; i < 300; ++i) {
    const CellBox occluder =
        around(random.in(5.0, 12.0) * random.unit(), {random.in(0.5, 4.0), random.in(0.5, 4.0), random.in(0.5, 4.0)});
    const auto frustum = shadow_frustum(box_occluder(occluder), cell);
    if (!frustum) continue;
    for (int k = 0; k < 30; ++k) {
      const glm::dvec3 p =
          0.5 * (occluder.min + occluder.max) * random.in(1.0, 3.0) + random.in(0.0, 3.0) * random.unit();
      // The eyes from which a convex body hides a point are a convex set: all of the cell iff its corners.
      bool is_hidden = true;
      for (int c = 0; c < 8; ++c) is_hidden = is_hidden && meets(occluder, corner(cell, c), p);
      const bool is_held = holds(*frustum, {p, p});
      EXPECT_TRUE(is_hidden == is_held || is_at_border(*frustum, p)) << i;
      ++(is_hidden ? hidden : visible);
    }
  }
  EXPECT_GT(hidden, 300);
  EXPECT_GT(visible, 300);
}

TEST(ShadowFrustum, IsNoneWhereTheyMeet) {
  EXPECT_FALSE(shadow_frustum(box_occluder({{0.5, 0.5, 0.5}, {3, 3, 3}}), cell));
}

// Calls hides(box) for random boxes among random houses and shoots segments at those that are said to be hidden.
template <typename Make>
int count_hidden(std::uint32_t seed, const Make& make) {
  test::RandomShapes random(seed);
  int hidden = 0;
  for (int i = 0; i < 6; ++i) {
    const std::vector<CellBox> houses = random_houses(random, 30);
    const auto occlusion = make(houses);
    for (int k = 0; k < 400; ++k) {
      const CellBox box = random_box(random);
      if (!occlusion.hides(box)) continue;
      ++hidden;
      for (int ray = 0; ray < 30; ++ray) EXPECT_TRUE(is_stopped(houses, point_in(cell, random), point_in(box, random)));
    }
  }
  return hidden;
}

TEST(CullMap, HidesOnlyWhatIsHidden) {
  const int hidden = count_hidden(4, [](const std::vector<CellBox>& houses) {
    CullMap map(scene, 128);
    for (const CellBox& house : houses)
      if (const auto frustum = shadow_frustum(box_occluder(house), cell)) map.add(*frustum);
    return map;
  });
  EXPECT_GT(hidden, 100);
}

template <typename Options>
int count_hidden_shrunk(const Options& options) {
  return count_hidden(5, [&](const std::vector<CellBox>& houses) {
    std::vector<ConvexOccluder> occluders;
    for (const CellBox& house : houses) occluders.push_back(box_occluder(house));
    return ShrunkOcclusion(cell, occluders, scene, options);
  });
}

TEST(ShrunkOcclusion, HidesOnlyWhatIsHidden) {
  const int middle = count_hidden_shrunk(ShrunkOptions{.best_point = false, .resolution = 128});
  const int best = count_hidden_shrunk(ShrunkOptions{.best_point = true, .resolution = 128});
  EXPECT_GT(middle, 50);
  EXPECT_GT(best, middle);  // the same boxes
}

// Two walls that overlap by 2.6 hide together what neither hides alone: at x = 10 segments from the cell to the box
// have y from -2.4 to 1.5.
TEST(ShrunkOcclusion, FusesOccluders) {
  const std::vector<ConvexOccluder> walls = {box_occluder({{10, -20, -20}, {11, 1.3, 20}}),
                                             box_occluder({{10, -1.3, -20}, {11, 20, 20}})};
  const CellBox big_scene{glm::dvec3(-60.0), glm::dvec3(60.0)}, box{{20, -4, -1}, {21, 2, 1}};
  for (const ConvexOccluder& wall : walls) {
    const auto frustum = shadow_frustum(wall, cell);
    ASSERT_TRUE(frustum);
    EXPECT_FALSE(holds(*frustum, box));
  }
  EXPECT_TRUE(ShrunkOcclusion(cell, walls, big_scene, {.best_point = true, .resolution = 256}).hides(box));
  EXPECT_FALSE(ShrunkOcclusion(cell, std::span(walls).first(1), big_scene, {}).hides(box));
}

// A square of half 8 at x = 10: from the middle of the cell its shrunk frustum has the slope 7 / 11 = 0.636, within the
// pixel from 0 to 2/3 of an image of 4 x 4 pixels. What is up to y = 66 at x = 100 is seen past the square, whose umbra
// ends there at 8 + 90 * 7 / 11 = 65.3.
TEST(ShrunkOcclusion, DropsPixelsThatAreCoveredInPart) {
  const CellBox big_scene{glm::dvec3(-200.0), glm::dvec3(200.0)}, across{{100, 62, 0}, {101, 66, 1}},
      inside{{100, 1, 1}, {101, 2, 2}};
  const std::vector<ConvexOccluder> square = {polygon_occluder({{10, -8, -8}, {10, 8, -8}, {10, 8, 8}, {10, -8, 8}})};
  const ShrunkOcclusion coarse(cell, square, big_scene, {.best_point = false, .resolution = 4});
  EXPECT_FALSE(coarse.hides(across));
  EXPECT_FALSE(coarse.hides(inside));
  EXPECT_TRUE(ShrunkOcclusion(cell, square, big_scene, {.best_point = false, .resolution = 64}).hides(inside));
}

// From farther behind the cell a square is shrunk less: at half = 2.35, from the middle of the cell the frustum's
// planes have slope (2.35 - 1) / 11, and at x = 19 reach to 19 * 0.1227 = 2.33 < 3; from the apex, x = 10 - 2.35 /
// 0.1227 = -9.1, to 28.1 * 0.1227 = 3.45.
TEST(ShrunkOcclusion, IsBestFromTheApex) {
  const CellBox box{{19, -3, -3}, {21, 3, 3}}, big_scene{glm::dvec3(-60.0), glm::dvec3(60.0)};
  const double half = 2.35;
  const std::vector<ConvexOccluder> square = {
      polygon_occluder({{10, -half, -half}, {10, half, -half}, {10, half, half}, {10, -half, half}})};
  EXPECT_FALSE(ShrunkOcclusion(cell, square, big_scene, {.best_point = false}).hides(box));
  EXPECT_TRUE(ShrunkOcclusion(cell, square, big_scene, {.best_point = true}).hides(box));
}

}  // namespace
}  // namespace occlod::paper
