// Bias, alpha, and the morph of ranges, in closed form and against counted pixels.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <random>

#include "hlod/draw/frame_scene.h"
#include "occlod/device.h"
#include "papers/trial_traverser.h"
#include "support/hand_made_hlod.h"
#include "support/scripted_device.h"

namespace occlod::hlod {
namespace {

TEST(BiasFunction, ClosedForms) {
  EXPECT_DOUBLE_EQ((Bias{1.0, 0.3}(0.3)), 0.3);                 // S(t) = t
  EXPECT_DOUBLE_EQ((Bias{1.0, 0.3}(0.15)), 0.15 * 0.15 / 0.3);  // below t less than mu
  EXPECT_DOUBLE_EQ((Bias{1.0, 0.3}(0.65)), 1.0 - 0.35 * 0.35 / 0.7);
  EXPECT_DOUBLE_EQ((Bias{0.5, 0.3}(0.15)), 0.5 * 0.15 + 0.5 * 0.075);
  for (const double mu : {0.0, 1e-9, 0.1, 0.5, 0.99, 1.0}) {
    EXPECT_DOUBLE_EQ((Bias{0.0, 0.3}(mu)), mu);  // Charalambos 2006
    EXPECT_DOUBLE_EQ((Bias{1.0, 0.0}(mu)), 1.0 - (1.0 - mu) * (1.0 - mu));
    EXPECT_DOUBLE_EQ((Bias{1.0, 1.0}(mu)), mu * mu);
    EXPECT_EQ(no_bias(mu), mu > 0.0 ? 1.0 : 0.0);
  }
}

TEST(BiasFunction, IsMonotoneAndKeepsZeroAndOne) {
  for (int s = 0; s <= 10; ++s)
    for (int t = 0; t <= 10; ++t) {
      const Bias bias{s / 10.0, t / 10.0};
      EXPECT_EQ(bias(0.0), 0.0);
      EXPECT_EQ(bias(1.0), 1.0);
      EXPECT_EQ(bias(-1.0), 0.0);
      EXPECT_EQ(bias(7.0), 1.0);  // more pixels than the box covers
      EXPECT_EQ(bias(std::nan("")), 0.0);
      for (int i = 0; i < 1000; ++i) {
        const double here = bias(i / 1000.0), next = bias((i + 1) / 1000.0);
        EXPECT_LE(here, next);
        EXPECT_LE(next - here, 0.00201);  // no jump: the slope is 2 at most
        EXPECT_LE(next, 1.0);
      }
    }
}

TEST(BiasFunction, TheTurningPointParts) {
  for (int t = 1; t <= 9; ++t)
    for (int i = 1; i < 100; ++i) {
      const double mu = i / 100.0, turn = t / 10.0;
      const double biased = Bias{1.0, turn}(mu);
      EXPECT_EQ(biased < mu - 1e-12, mu < turn - 1e-9);
      EXPECT_EQ(biased > mu + 1e-12, mu > turn + 1e-9);
      EXPECT_GE((Bias{1.0, turn - 0.1}(mu)), biased - 1e-12);  // the smaller t, the more counts
    }
}

TEST(OutlineArea, ClosedForms) {
  using Points = std::vector<glm::dvec2>;
  const glm::dvec2 image(10.0, 8.0);
  const auto area = [&](const Points& points) { return hull_area_inside(points, image); };
  EXPECT_DOUBLE_EQ(area({{1, 1}, {4, 1}, {4, 3}, {1, 3}, {2, 2}, {3, 1}, {1, 2}, {4, 3}}), 6.0);
  EXPECT_DOUBLE_EQ(area({{-5, -5}, {20, -5}, {20, 20}, {-5, 20}}), 80.0);  // all of the image
  EXPECT_DOUBLE_EQ(area({{8, 6}, {12, 6}, {12, 10}, {8, 10}}), 4.0);       // at a corner
  EXPECT_DOUBLE_EQ(area({{0, 0}, {6, 0}, {0, 6}}), 18.0);
  EXPECT_DOUBLE_EQ(area({{-2, -2}, {4, -2}, {-2, 4}}), 2.0);  // x + y < 2
  EXPECT_DOUBLE_EQ(area({{12, 1}, {14, 1}, {14, 3}}), 0.0);   // beside
  EXPECT_DOUBLE_EQ(area({{3, 1}, {3, 5}, {3, 3}}), 0.0);      // a line
  EXPECT_DOUBLE_EQ(area({{3, 3}, {3, 3}}), 0.0);
  EXPECT_DOUBLE_EQ(area({{3, 3}}), 0.0);
}

// Alone on the screen, a box passes with all its pixels. A convex outline of perimeter p covers the pixels of its area,
// give or take p / sqrt 2 + 1, and far less on average.
TEST(Alpha, ExactIsWhatAQueryCountsOnAnEmptyScreen) {
  std::mt19937_64 random(7);
  const auto number = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
  };
  SoftwareDevice device;
  const Hlod hlod = occlod::test::one_panel({0.0F, 0.0F, 0.0F}, {1.0F, 1.0F});
  int compared = 0;
  double sum = 0.0, differences = 0.0;
  for (int i = 0; i < 400; ++i) {
    Camera camera;
    camera.eye = {number(-4, 4), number(-4, 4), number(3, 9)};
    camera.target = {number(-1, 1), number(-1, 1), 0.0};
    camera.width = 200;
    camera.height = 150;
    if (i % 4 == 0) camera.orthographic_height = 4.0;
    const View view(camera);
    glm::dmat4 place = glm::rotate(glm::dmat4(1.0), number(0, 6), glm::dvec3(number(-1, 1), number(-1, 1), 1.0));
    place[0] *= number(0.5, 2.0) * (i % 3 == 0 ? -1.0 : 1.0);
    const PlacedHlod placed{&hlod, place};
    Node node;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = number(-2, 2), size = i % 5 == axis ? 0.0 : number(0, 1.5);
      node.box.min[axis] = static_cast<float>(a);
      node.box.max[axis] = static_cast<float>(a + size);
    }
    const ObjectFrame frame(view, placed, {});
    device.begin_frame(view, {&placed, 1});
    const BoxRef box{0, node.box};
    const double counted = device.wait(device.ask({&box, 1}))[0];
    device.end_frame();
    const std::optional<double> pixels = frame.box_pixels(node);
    ASSERT_TRUE(pixels);
    EXPECT_NEAR(*pixels, counted, 1.0 + 4.0 * std::sqrt(counted + 1.0)) << i;
    if (counted < 100.0) continue;
    ++compared;
    sum += counted;
    differences += std::abs(*pixels - counted);
  }
  EXPECT_GT(compared, 200);
  EXPECT_LT(differences, 0.005 * sum);
}

Camera straight_ahead() {
  Camera camera;
  camera.eye = {0.0, 0.0, 10.0};
  camera.fov_y_deg = 90.0;
  camera.width = camera.height = 200;  // an object unit covers 100 pixels at distance 1
  camera.near = 0.1;
  return camera;
}

// A cube of volume 8 has an edge of 2. From 10 away it covers (2 * 100 / 10)^2 pixels, whatever shape the box has.
TEST(Alpha, OfThePaperIsAFaceOfACube) {
  const Hlod hlod = occlod::test::one_panel({0.0F, 0.0F, 0.0F}, {1.0F, 1.0F});
  Trial trial;
  trial.alpha = Alpha::paper;
  Node node;
  node.box = {glm::vec3(-2.0F, -1.0F, -0.5F), glm::vec3(2.0F, 1.0F, 0.5F)};
  const View view(straight_ahead());
  const auto pixels = [&](const glm::dmat4& place) {
    return *ObjectFrame(view, {&hlod, place}, trial).box_pixels(node);
  };
  EXPECT_NEAR(pixels(glm::dmat4(1.0)), 400.0, 1e-6);
  EXPECT_NEAR(pixels(glm::rotate(glm::dmat4(1.0), 1.0, glm::dvec3(1.0, 2.0, 3.0))), 400.0, 1e-6);
  EXPECT_NEAR(pixels(glm::scale(glm::dmat4(1.0), glm::dvec3(0.5, 1.0, 2.0))), 400.0, 1e-6);  // the same volume
  EXPECT_NEAR(pixels(glm::scale(glm::dmat4(1.0), glm::dvec3(-0.5))), 100.0, 1e-6);
  node.box.max.z = node.box.min.z;
  EXPECT_EQ(pixels(glm::dmat4(1.0)), 0.0);
  node.sphere.center = glm::vec3(0.0F, 0.0F, 10.0F);  // at the eye: no more than the image
  node.box.max.z = 0.5F;
  EXPECT_EQ(pixels(glm::dmat4(1.0)), 40'000.0);
}

TEST(Alpha, ThereIsNoneWhereDevicesWouldNotDrawTheBox) {
  const Hlod hlod = occlod::test::one_panel({0.0F, 0.0F, 0.0F}, {1.0F, 1.0F});
  for (const Alpha alpha : {Alpha::exact, Alpha::paper}) {
    Trial trial;
    trial.alpha = alpha;
    const ObjectFrame frame(View(straight_ahead()), {&hlod}, trial);
    Node node;
    node.box = {glm::vec3(-1.0F, -1.0F, 0.0F), glm::vec3(1.0F, 1.0F, 20.0F)};  // around the eye
    EXPECT_FALSE(frame.box_pixels(node));
    node.box.max.z = 10.0F;  // the eye on its face
    EXPECT_FALSE(frame.box_pixels(node));
    node.box.max.z = 9.95F;  // up to the near plane
    EXPECT_FALSE(frame.box_pixels(node));
    node.box.max.z = 9.0F;
    EXPECT_TRUE(frame.box_pixels(node));
  }
}

// two_rows() from (-2, 0, 10), where an object unit at distance 1 covers 50 pixels: 10 px for node 0, 5 px for node 1,
// 50 / 14 px for node 2. Leaves slide from 1 to 0 while the parent's error goes from the tolerance to twice that.
TEST(Geomorph, GoesByTheParentsError) {
  const Hlod rows = occlod::test::two_rows();
  const PlacedHlod placed{&rows};
  TrialTraverser traverser({&placed, 1});
  occlod::test::ScriptedDevice device;
  Camera camera = straight_ahead();
  camera.eye = {-2.0, 0.0, 10.0};
  camera.target = {-2.0, 0.0, 0.0};
  camera.width = camera.height = 100;
  TrialOptions options;
  options.strategy = TrialStrategy::vfc;
  options.geomorph = true;
  const auto morph_of = [&](NodeId node, double tolerance_px) -> double {
    options.tolerance_px = tolerance_px;
    const Frame& frame = traverser.draw_frame(View(camera), device, options);
    for (const DrawnNode& drawn : frame.draws)
      if (drawn.node == node) return static_cast<double>(frame.ranges[drawn.first_range].morph);
    return -1.0;
  };
  EXPECT_NEAR(morph_of(3, 2.5), 0.0, 1e-6);  // 5 px is twice the tolerance
  EXPECT_NEAR(morph_of(3, 4.0), 0.75, 1e-6);
  EXPECT_NEAR(morph_of(3, 4.999), 1.0, 1e-3);
  EXPECT_EQ(morph_of(3, 5.001), -1.0);        // node 1 is drawn,
  EXPECT_NEAR(morph_of(1, 8.0), 0.75, 1e-6);  // and slides to node 0
  EXPECT_NEAR(morph_of(6, 2.0), 2.0 - 50.0 / 14.0 / 2.0, 1e-6);
  EXPECT_NEAR(morph_of(3, 0.0), 0.0, 0.0);
  options.geomorph = false;
  EXPECT_EQ(morph_of(3, 4.0), 0.0);
}

}  // namespace
}  // namespace occlod::hlod
