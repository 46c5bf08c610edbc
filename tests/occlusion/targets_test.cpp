// Batches find the rectangles that single bounds have, bit for bit, with every instruction set; so do the answers.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "occlod/visibility.h"
#include "oracle/random_shapes.h"
#include "raster/depth_kernels.h"
#include "raster/depth_pyramid.h"
#include "raster/every_target.h"
#include "raster/screen_bounds.h"
#include "raster/software_occlusion.h"

namespace occlod {
namespace {

using test::BoundKind;
using test::for_every_target;
using test::RandomShapes;

template <class Shape>
void find_bounds(const BoundsView& view, const std::vector<Shape>& shapes, BoundsOutput& found) {
  find_screen_bounds(view, shapes, found);
}
void find_bounds(const BoundsView& view, const std::vector<PointHull>& hulls, BoundsOutput& found) {
  DiagonalsOutput diagonals;
  find_screen_bounds(view, hulls, found, diagonals);
}

template <class Shape>
void expect_lanes_equal_singles(const View& view, const ObjectView& object, const std::vector<Shape>& shapes,
                                const char* target) {
  BoundsOutput found;
  find_bounds(BoundsView(view, object), shapes, found);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const std::optional<ScreenBounds> expected = screen_bounds(view, object, {0, shapes[i]});
    ASSERT_EQ(found.trusted[i], expected ? 1 : 0) << target << " " << i;
    if (!expected) continue;
    ASSERT_EQ(found.largest_nearness[i], expected->largest_nearness) << target;
    ASSERT_EQ(found.x0[i], expected->rect.x0) << target;
    ASSERT_EQ(found.y0[i], expected->rect.y0) << target;
    ASSERT_EQ(found.x1[i], expected->rect.x1) << target;
    ASSERT_EQ(found.y1[i], expected->rect.y1) << target;
  }
}

// What no rectangle can be trusted for, and what is all but that.
void add_adversaries(std::vector<Sphere>& spheres, std::vector<Box>& boxes, std::vector<Cylinder>& cylinders) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const float huge = std::numeric_limits<float>::max();
  for (const float bad : {nan, infinity, -infinity, huge, -huge, -1.0F, 0.0F, 1e-40F, 1e-12F, 1e12F}) {
    spheres.push_back({{0.1F, 0.2F, -5.0F}, bad});
    spheres.push_back({{bad, 0.2F, -5.0F}, 0.5F});
    boxes.push_back({{bad, -1.0F, -5.0F}, {1.0F, 1.0F, -4.0F}});
    boxes.push_back({{-1.0F, -1.0F, -5.0F}, {1.0F, bad, -4.0F}});
    cylinders.push_back({{0.0F, 0.0F, -5.0F}, bad, {0.0F, 1.0F, 0.0F}, -1.0F, 1.0F});
    cylinders.push_back({{0.0F, 0.0F, -5.0F}, 0.5F, {0.0F, 1.0F, 0.0F}, bad, 1.0F});
    cylinders.push_back({{0.0F, 0.0F, -5.0F}, 0.5F, {0.0F, bad, 0.0F}, -1.0F, 1.0F});
  }
}

template <class Shape>
void keep_a_batch(std::vector<Shape>& shapes) {
  shapes.resize(std::min(shapes.size(), bounds_batch_size));
}

TEST(Targets, FindTheRectanglesOfSingleBounds) {
  for_every_target([](const char* target) {
    RandomShapes random(5);
    for (int n = 0; n < 200; ++n) {
      const View view = random.view();
      const ObjectView object(view, random.placement());
      std::vector<Sphere> spheres;
      std::vector<Box> boxes;
      std::vector<Cylinder> cylinders;
      std::vector<PointHull> hulls;
      if (n % 10 == 0) add_adversaries(spheres, boxes, cylinders);
      for (int i = 0; i < 5 + n % 20; ++i) {
        const double size = random.in(0.001, 3.0);
        spheres.push_back(std::get<Sphere>(random.bound(BoundKind::sphere, size).shape));
        boxes.push_back(std::get<Box>(random.bound(BoundKind::box, size).shape));
        cylinders.push_back(std::get<Cylinder>(random.bound(BoundKind::cylinder, size).shape));
        hulls.push_back(std::get<PointHull>(random.bound(BoundKind::hull, size).shape));
      }
      keep_a_batch(spheres);
      keep_a_batch(boxes);
      keep_a_batch(cylinders);
      expect_lanes_equal_singles(view, object, spheres, target);
      expect_lanes_equal_singles(view, object, boxes, target);
      expect_lanes_equal_singles(view, object, cylinders, target);
      expect_lanes_equal_singles(view, object, hulls, target);
      if (testing::Test::HasFatalFailure()) return;
    }
  });
}

// Those of a batch and those of single hulls cut off the same corners, but for rounding.
TEST(Targets, FindTheDiagonalsOfSingleHulls) {
  for_every_target([](const char* target) {
    SCOPED_TRACE(target);
    RandomShapes random(8);
    std::size_t compared = 0;
    for (int n = 0; n < 100; ++n) {
      const View view = random.view();
      const ObjectView object(view, random.placement());
      std::vector<PointHull> hulls;
      for (int i = 0; i < 20; ++i)
        hulls.push_back(std::get<PointHull>(random.bound(BoundKind::hull, random.in(0.001, 3.0)).shape));
      BoundsOutput found;
      DiagonalsOutput diagonals;
      find_screen_bounds(BoundsView(view, object), hulls, found, diagonals);
      for (std::size_t i = 0; i < hulls.size(); ++i) {
        if (found.trusted[i] == 0) continue;
        ++compared;
        const Diagonals expected = screen_diagonals(view, object, {0, hulls[i]});
        const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-9 * (1.0 + std::abs(b)); };
        ASSERT_PRED2(near, diagonals.sum_low[i], expected.sum_low);
        ASSERT_PRED2(near, diagonals.sum_high[i], expected.sum_high);
        ASSERT_PRED2(near, diagonals.difference_low[i], expected.difference_low);
        ASSERT_PRED2(near, diagonals.difference_high[i], expected.difference_high);
      }
    }
    EXPECT_GT(compared, 500U);
  });
}

struct Scene {
  View view;
  std::vector<ObjectView> objects;
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<VisibilityQuery> queries;
};

Scene random_scene(RandomShapes& random) {
  Scene scene{random.view(), {}, {}, {}, {}};
  for (int i = 0; i < 2; ++i) scene.objects.emplace_back(scene.view, random.placement());
  for (std::uint32_t i = 0; i < 15; ++i) {
    for (int k = 0; k < 3; ++k) scene.positions.emplace_back(random.point(4.0));
    scene.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  for (int i = 0; i < 300; ++i) {
    const BoundKind kind = random.kind();
    VisibilityQuery query = random.bound(kind, 0.4);
    query.object = random.in(0.0, 1.0) < 0.5 ? 0U : 1U;
    scene.queries.push_back(query);
  }
  std::vector<Sphere> spheres;
  std::vector<Box> boxes;
  std::vector<Cylinder> cylinders;
  add_adversaries(spheres, boxes, cylinders);
  for (const Sphere& sphere : spheres) scene.queries.push_back({0, sphere});
  for (const Box& box : boxes) scene.queries.push_back({1, box});
  for (const Cylinder& cylinder : cylinders) scene.queries.push_back({0, cylinder});
  return scene;
}

void show(Visibility& backend, const Scene& scene) {
  backend.begin_view(scene.view, scene.objects);
  const std::vector<OccluderPart> parts = {{1, scene.positions, scene.triangles}};
  backend.draw_occluder(parts);
}

std::vector<std::uint32_t> one_by_one(Visibility& backend, const Scene& scene) {
  std::vector<std::uint32_t> answers;
  for (const VisibilityQuery& query : scene.queries) {
    backend.submit(query);
    answers.push_back(backend.collect());
  }
  return answers;
}

// Kinds and objects mixed, so that batches are cut short, answered from the middle and filled again.
std::vector<std::uint32_t> together(Visibility& backend, const Scene& scene) {
  std::vector<std::uint32_t> answers;
  for (std::size_t i = 0; i < scene.queries.size(); ++i) {
    backend.submit(scene.queries[i]);
    if (i % 150 == 149)
      for (int k = 0; k < 70; ++k) answers.push_back(backend.collect());
  }
  while (answers.size() < scene.queries.size()) answers.push_back(backend.collect());
  return answers;
}

std::vector<std::uint32_t> at_once(Visibility& backend, const Scene& scene) {
  std::vector<std::uint32_t> answers(scene.queries.size());
  backend.answer(scene.queries, answers);
  return answers;
}

TEST(Targets, AnswerTheSameTogetherAndOneByOne) {
  for (const bool count : {false, true}) {
    std::vector<std::vector<std::uint32_t>> expected;
    for_every_target([&](const char* target) {
      RandomShapes random(6);
      const auto backend = make_software_occlusion(count);
      for (std::size_t n = 0; n < 20; ++n) {
        const Scene scene = random_scene(random);
        show(*backend, scene);
        const std::vector<std::uint32_t> singles = one_by_one(*backend, scene);
        ASSERT_EQ(together(*backend, scene), singles) << target;
        ASSERT_EQ(at_once(*backend, scene), singles) << target;
        if (expected.size() == n) expected.push_back(singles);
        ASSERT_EQ(singles, expected[n]) << target;
      }
    });
    std::size_t hidden = 0, visible = 0;
    for (const auto& answers : expected)
      for (const std::uint32_t answer : answers) ++(answer == 0 ? hidden : visible);
    EXPECT_GT(hidden, 500U);
    EXPECT_GT(visible, 500U);
  }
}

// A point that is told to be visible shows every bound that holds it; the same points with every instruction set.
TEST(Targets, FindPointsThatShowTheirBounds) {
  std::vector<std::vector<std::uint8_t>> expected;
  for_every_target([&](const char* target) {
    SCOPED_TRACE(target);
    RandomShapes random(9);
    const auto backend = make_software_occlusion();
    for (std::size_t n = 0; n < 20; ++n) {
      const Scene scene = random_scene(random);
      show(*backend, scene);
      std::vector<VisibilityQuery> bounds;
      std::vector<glm::vec3> points;
      for (int i = 0; i < 200; ++i) {
        bounds.push_back(random.bound(random.kind(), 0.4));
        const auto* hull = std::get_if<PointHull>(&bounds.back().shape);
        points.emplace_back(hull != nullptr ? hull->points.front() : glm::vec3(random.sample(bounds.back())));
        if (hull == nullptr) bounds.back().shape = Sphere{points.back(), 0.001F};
      }
      std::vector<std::uint8_t> shows(points.size(), 2);
      backend->find_visible_points(0, points, shows);
      const std::vector<std::uint32_t> answers = at_once(*backend, {scene.view, {}, {}, {}, bounds});
      for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_LE(shows[i], 1);
        ASSERT_LE(shows[i], answers[i]) << i;
      }
      if (expected.size() == n) expected.push_back(shows);
      ASSERT_EQ(shows, expected[n]);
    }
  });
  std::size_t shown = 0, all = 0;
  for (const auto& shows : expected)
    for (const std::uint8_t show : shows) {
      shown += show;
      ++all;
    }
  EXPECT_GT(shown, all / 20);
  EXPECT_LT(shown, all / 2);
}

TEST(Targets, ReduceTheSamePyramid) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {31, 33}, {64, 2}, {65, 66}, {256, 3}, {1025, 35}}) {
    RandomShapes random(7);
    DepthBuffer depth;
    depth.reset(width, height);
    for (float& z : depth.nearness) z = static_cast<float>(random.in(0.0, 1.0));
    for_every_target([&, w = width, h = height](const char* target) {
      DepthPyramid pyramid;
      pyramid.build(depth);
      for (int level = 1; level < pyramid.level_count(); ++level)
        for (int y = 0; y << level < h; ++y)
          for (int x = 0; x << level < w; ++x) {
            float expected = std::numeric_limits<float>::infinity();
            for (int j = 2 * y; j <= 2 * y + 1 && j << (level - 1) < h; ++j)
              for (int i = 2 * x; i <= 2 * x + 1 && i << (level - 1) < w; ++i)
                expected = std::min(expected, pyramid.farthest(level - 1, i, j));
            ASSERT_EQ(pyramid.farthest(level, x, y), expected) << target << " level " << level << ": " << x << "," << y;
          }
    });
  }
}

}  // namespace
}  // namespace occlod
