// The formulas of Guthe, Balazs and Klein 2006, by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "hlod/draw/query_value.h"
#include "papers/trial_traverser.h"
#include "traverse/small_scenes.h"

namespace occlod::hlod {
namespace {

// 800 x 600 pixels at 90 degrees: the focal length is 300.
constexpr ImageScale image{300.0, 480'000.0, false};

// As printed: (1 / (d sqrt(w/h) 2 tan(theta/2)))^2 A_bb / 6 with d = 10, w/h = 4/3, tan = 1: a cube of edge 2 has a
// face of 4, so 4 / (100 * 4/3 * 4).
TEST(Coverage, OfACubeIsThatOfItsFace) {
  EXPECT_DOUBLE_EQ(box_coverage(24.0, 10.0, image), 4.0 / (100.0 * 4.0 / 3.0 * 4.0));
  EXPECT_DOUBLE_EQ(box_coverage(24.0, 10.0, image), 60.0 * 60.0 / 480'000.0);  // 2 * 300 / 10 pixels wide
  EXPECT_DOUBLE_EQ(box_coverage(24.0, 10.0, {30.0, 480'000.0, true}), 60.0 * 60.0 / 480'000.0);
}

TEST(Coverage, IsAtMostAll) {
  EXPECT_EQ(box_coverage(24.0, 0.01, image), 1.0);
  EXPECT_EQ(box_coverage(24.0, 0.0, image), 1.0);
  EXPECT_EQ(box_coverage(0.0, 0.0, image), 1.0);
  EXPECT_EQ(box_coverage(0.0, 1.0, image), 0.0);
}

// A ball in its cube covers pi r^2 of (2 r)^2: pi / 4.
TEST(Coverage, OfABallIsThatOfItsDisc) {
  const double pi = std::acos(-1.0);
  EXPECT_DOUBLE_EQ(coverage_ratio(4.0 * pi, 24.0), pi / 4.0);
  EXPECT_DOUBLE_EQ(mesh_coverage(0.5, 0.25), 0.125);
  EXPECT_DOUBLE_EQ(mesh_coverage(0.5, 3.0), 0.5);  // crumpled
  EXPECT_EQ(coverage_ratio(0.0, 0.0), 1.0);
}

TEST(Coverage, AddsUp) {
  EXPECT_DOUBLE_EQ(covered_with(0.0, 0.25), 0.25);
  EXPECT_DOUBLE_EQ(covered_with(0.25, 0.25), 0.25 + 0.75 * 0.25);
  EXPECT_DOUBLE_EQ(covered_with(1.0, 0.25), 1.0);
}

// The square roots of 0.81 and 0.25 are 0.9 and 0.5.
TEST(CoverProbability, IsByEdgesOfSquares) {
  EXPECT_NEAR(cover_probability(0.81, 0.25), 0.16, 1e-15);
  EXPECT_EQ(cover_probability(0.25, 0.25), 0.0);
  EXPECT_EQ(cover_probability(0.25, 0.81), 0.0);
  EXPECT_EQ(cover_probability(0.0, 0.0), 0.0);
  EXPECT_EQ(cover_probability(1.0, 1.0), 0.0);
  EXPECT_DOUBLE_EQ(cover_probability(0.5, 0.0), 0.5);  // of a point
}

// A planet that fills a small part of the image, from outside.
Camera far_away(const Hlod& planet) {
  const Box& box = planet.data().box;
  const glm::dvec3 middle = 0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max));
  const double size = glm::distance(glm::dvec3(box.min), glm::dvec3(box.max));
  Camera camera;
  camera.eye = middle + glm::dvec3(0.0, 0.0, 2.0 * size);
  camera.target = middle;
  camera.near = 0.01 * size;
  camera.far = 10.0 * size;
  return camera;
}

TEST(Covered, SceneSharesAreThoseOfTheRootsBoxes) {
  const Hlod& planet = test::planet(Grouping::nested);
  ASSERT_EQ(planet.data().roots.size(), 1U);
  Camera camera = far_away(planet);
  const ObjectFrame outside(View(camera), {&planet}, {});
  const double pixels = outside.box_pixels(planet.node(planet.data().roots[0])).value();
  EXPECT_DOUBLE_EQ(root_share(planet, outside), pixels / outside.pixels());
  EXPECT_LT(root_share(planet, outside), 0.5);
  camera.eye = camera.target;  // inside
  camera.target.z -= 1.0;
  EXPECT_EQ(root_share(planet, ObjectFrame(View(camera), {&planet}, {})), 1.0);
}

// The near half hides the far half, however small both are in the image. As printed, what covers a tenth of the image
// hides nothing with a probability of more than a tenth.
TEST(Covered, OfASceneThatHidesItselfMoreIsAskedAbout) {
  const Hlod& planet = test::planet(Grouping::nested);
  const View view(far_away(planet));
  const std::vector<PlacedHlod> objects{{&planet}};
  const auto drawn = [&](CoverModel model) {
    SoftwareDevice device;
    TrialTraverser traverser(objects);
    TrialOptions options;
    options.strategy = TrialStrategy::nohc;
    options.cover_model = model;
    options.tolerance_px = 0.0;
    options.costs = {.name = "test", .draw_ns = 10'000.0, .query_ns = 3'000.0};
    return traverser.draw_frame(view, device, options).stats;
  };
  EXPECT_GT(drawn(CoverModel::in_scene).hidden_nodes, drawn(CoverModel::printed).hidden_nodes);
  EXPECT_LT(drawn(CoverModel::in_scene).drawn_nodes, drawn(CoverModel::printed).drawn_nodes);
}

TEST(OcclusionProbability, IsByTheLastFrame) {
  EXPECT_DOUBLE_EQ(occlusion_probability(0.5, LastSight::visible), 0.125);
  EXPECT_DOUBLE_EQ(occlusion_probability(0.5, LastSight::outside), 0.5);
  EXPECT_DOUBLE_EQ(occlusion_probability(0.5, LastSight::hidden), 1.0);
}

}  // namespace
}  // namespace occlod::hlod
