#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <random>
#include <utility>

#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "occlod/hlod.h"
#include "support/meshes.h"

namespace occlod::hlod {
namespace {

TEST(ScreenError, TheLargerOfTwoTerms) {
  Node node;
  node.box = {glm::vec3(1.0F, -1.0F, -1.0F), glm::vec3(3.0F, 1.0F, 1.0F)};
  node.lod_box = {glm::vec3(0.0F, -1.0F, -1.0F), glm::vec3(3.0F, 1.0F, 1.0F)};
  node.sphere = {glm::vec3(2.0F, 0.0F, 0.0F), 2.0F};
  node.error = 0.1F;
  node.child_error = 0.05F;
  const auto at = [](const glm::dvec3& eye) { return ScreenScale{eye, 1000.0, 0.01}; };
  // 5 from the box, 4 from the lod_box: 1000 * max(0.1 / 5, 0.05 / 4).
  EXPECT_NEAR(screen_error_px(node, at({-4.0, 0.0, 0.0})), 20.0, 1e-5);
  // 1.2 and 0.2: 1000 * max(0.1 / 1.2, 0.05 / 0.2).
  EXPECT_NEAR(screen_error_px(node, at({-0.2, 0.0, 0.0})), 250.0, 1e-4);
  // Off a corner: (1, 1, 1) beyond, sqrt 3 away from both.
  EXPECT_NEAR(screen_error_px(node, at({4.0, 2.0, 2.0})), 100.0 / std::sqrt(3.0), 1e-5);
  // Inside counts as at the near plane.
  EXPECT_NEAR(screen_error_px(node, at({2.0, 0.0, 0.0})), 1000.0 * 0.1 / 0.01, 1e-3);
  // 6 from the centre, 4 from the sphere.
  EXPECT_NEAR(sphere_error_px(node, at({-4.0, 0.0, 0.0})), 25.0, 1e-5);
  EXPECT_NEAR(sphere_error_px(node, at({2.0, 1.0, 0.0})), 1000.0 * 0.1 / 0.01, 1e-3);
  // 4 from the lod_box, whatever the other errors are.
  node.guaranteed_error = 0.2F;
  EXPECT_NEAR(guaranteed_error_px(node, at({-4.0, 0.0, 0.0})), 50.0, 1e-5);
}

// From far away to within the mesh, and exactly on corners of boxes.
std::vector<glm::dvec3> eyes_around(const Hlod& hlod) {
  std::mt19937_64 random(3);
  const auto number = [&] { return static_cast<double>(random() % 20'001) / 10'000.0 - 1.0; };
  std::vector<glm::dvec3> eyes;
  for (const double reach : {0.3, 1.0, 1.1, 3.0, 100.0, 1e7})
    for (int i = 0; i < 20; ++i) eyes.push_back(reach * glm::dvec3(number(), number(), number()));
  for (int i = 0; i < 40; ++i)
    eyes.emplace_back(corner(hlod.node(static_cast<NodeId>(random() % hlod.node_count())).box, i % 8));
  return eyes;
}

TEST(ScreenError, IsNeverLessThanAChilds) {
  for (const Grouping grouping : {Grouping::shifted, Grouping::nested})
    for (const TriangleMesh& mesh :
         {occlod::test::noisy_sphere(6, 1), generate("city", {{"blocks", 3}, {"facade_cells", 8}})}) {
      HlodBuildOptions options;
      options.node_triangles = 64;
      options.grouping = grouping;
      const Hlod hlod = build_hlod(mesh, options);
      for (const glm::dvec3& eye : eyes_around(hlod)) {
        const ScreenScale scale{eye, 935.0, 1e-4};
        for (NodeId n = 0; n < hlod.node_count(); ++n)
          for (const NodeId child : hlod.children(n)) {
            EXPECT_GE(screen_error_px(hlod.node(n), scale), screen_error_px(hlod.node(child), scale));
            EXPECT_GE(sphere_error_px(hlod.node(n), scale), sphere_error_px(hlod.node(child), scale));
            EXPECT_GE(guaranteed_error_px(hlod.node(n), scale), guaranteed_error_px(hlod.node(child), scale));
          }
      }
    }
}

// An error of 0.1 object units 5 object units before the eye, 1000 px focal length: 20 px.
TEST(ScreenScale, OfAPlacement) {
  Node node;
  node.box = node.lod_box = {glm::vec3(-1.0F, -1.0F, -2.0F), glm::vec3(1.0F, 1.0F, 0.0F)};
  node.sphere = {glm::vec3(0.0F, 0.0F, -1.0F), 1.0F};
  node.error = 0.1F;
  Camera camera;
  camera.eye = {0.0, 0.0, 5.0};
  camera.fov_y_deg = 90.0;
  camera.width = camera.height = 2000;
  const auto error = [&](const glm::dmat4& place, double (*metric)(const Node&, const ScreenScale&)) {
    const View view(camera);
    return metric(node, screen_scale(view, ObjectView(view, place)));
  };
  const glm::dmat4 unmoved(1.0);
  EXPECT_NEAR(error(unmoved, screen_error_px), 20.0, 1e-5);
  EXPECT_NEAR(error(unmoved, sphere_error_px), 20.0, 1e-5);
  // Twice as large and twice as far away looks the same.
  const glm::dmat4 doubled = glm::scale(glm::translate(unmoved, glm::dvec3(0.0, 0.0, -5.0)), glm::dvec3(2.0));
  EXPECT_NEAR(error(doubled, screen_error_px), 20.0, 1e-5);
  EXPECT_NEAR(error(doubled, sphere_error_px), 20.0, 1e-5);
  EXPECT_NEAR(error(glm::scale(unmoved, glm::dvec3(-1.0, 1.0, 1.0)), screen_error_px), 20.0, 1e-5);  // mirrored
  // Stretched across: errors may lie that way, the distance stays. Stretched ahead: the box grows away from the eye.
  EXPECT_NEAR(error(glm::scale(unmoved, glm::dvec3(3.0, 1.0, 1.0)), screen_error_px), 60.0, 1e-4);
  EXPECT_NEAR(error(glm::scale(unmoved, glm::dvec3(1.0, 1.0, 3.0)), screen_error_px), 60.0, 1e-4);
  // A shear by 1: stretches by the golden ratio at most, and by its inverse at least; both bounds are safe.
  glm::dmat4 sheared(1.0);
  sheared[1].x = 1.0;
  EXPECT_GE(error(sheared, screen_error_px), 20.0 * 1.618);
  EXPECT_LE(error(sheared, screen_error_px), 20.0 * 3.1);
  EXPECT_GE(error(sheared, sphere_error_px), 20.0 * 1.618);
  // 1e9 away from the origin, as is the camera: only the difference counts.
  camera.eye.x = camera.target.x = 1e9;
  EXPECT_NEAR(error(glm::translate(unmoved, glm::dvec3(1e9, 0.0, 0.0)), screen_error_px), 20.0, 1e-4);
  // Parallel rays: 2000 px for 10 units, from anywhere.
  camera.orthographic_height = 10.0;
  for (const double z : {5.0, 50.0}) {
    camera.eye.z = z;
    EXPECT_NEAR(error(glm::translate(unmoved, glm::dvec3(1e9, 0.0, 0.0)), screen_error_px), 20.0, 1e-5);
    EXPECT_NEAR(error(glm::scale(unmoved, glm::dvec3(2.0)), sphere_error_px), 40.0, 1e-5);
  }
}

TEST(ScreenScale, AtPowersOfTwoIsTheSameToTheBit) {
  Node node;
  node.box = node.lod_box = {glm::vec3(-1.0F, -0.7F, -2.0F), glm::vec3(1.0F, 1.0F, 0.3F)};
  node.sphere = {glm::vec3(0.1F, 0.0F, -1.0F), 1.0F};
  node.error = 0.1F;
  const auto errors = [&](int exponent) {
    const double scale = std::exp2(exponent);
    Camera camera;
    camera.eye = scale * glm::dvec3(0.3, 0.2, 5.0);
    camera.target = scale * glm::dvec3(0.1, 0.2, 0.0);
    camera.near *= scale;
    camera.far *= scale;
    const View view(camera);
    const ScreenScale s = screen_scale(view, ObjectView(view, glm::scale(glm::dmat4(1.0), glm::dvec3(scale))));
    return std::pair(screen_error_px(node, s), sphere_error_px(node, s));
  };
  for (const int exponent : {-60, -7, 3, 80}) EXPECT_EQ(errors(exponent), errors(0)) << exponent;
}

TEST(ScreenError, IsNeverLessThanAChildsWhereverItIsPlaced) {
  HlodBuildOptions options;
  options.node_triangles = 64;
  const Hlod hlod = build_hlod(occlod::test::noisy_sphere(5, 1), options);
  std::vector<glm::dmat4> places = {glm::scale(glm::dmat4(1.0), glm::dvec3(0.2, 3.0, -1.0))};
  places.push_back(places[0]);
  places[1][0].y = 0.4;  // sheared too
  std::mt19937_64 random(5);
  const auto number = [&] { return static_cast<double>(random() % 20'001) / 5'000.0 - 2.0; };
  for (const glm::dmat4& place : places)
    for (int i = 0; i < 60; ++i) {
      Camera camera;
      camera.eye = {number(), number(), number()};
      if (i % 4 == 0) camera.orthographic_height = 2.0;
      const View view(camera);
      const ScreenScale scale = screen_scale(view, ObjectView(view, place));
      for (NodeId n = 0; n < hlod.node_count(); ++n)
        for (const NodeId child : hlod.children(n)) {
          EXPECT_GE(screen_error_px(hlod.node(n), scale), screen_error_px(hlod.node(child), scale));
          EXPECT_GE(sphere_error_px(hlod.node(n), scale), sphere_error_px(hlod.node(child), scale));
        }
    }
}

}  // namespace
}  // namespace occlod::hlod
