// What a frame of an HLOD loses, counted against the input: faults that are planted must be seen, at any tolerance.
#include "hlod_reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "input_normals.h"
#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "support/meshes.h"

namespace occlod::tool {
namespace {

Camera camera_at(const glm::dvec3& eye, double far = 20.0) {
  Camera camera;
  camera.eye = eye;
  camera.target = glm::dvec3(0.0);
  camera.up = glm::dvec3(0.0, 0.0, 1.0);
  camera.width = 320;
  camera.height = 240;
  camera.near = 0.01;
  camera.far = far;
  return camera;
}

// An HLOD, and what frames of it are drawn with.
struct Case {
  explicit Case(const TriangleMesh& mesh) {
    hlod::HlodBuildOptions options;
    options.node_triangles = 64;
    hlod = build_hlod(mesh, options);
  }

  // Draws a frame of vfc.
  Front front(const View& view, double tolerance_px) const {
    hlod::Traverser traverser(placed);
    hlod::SoftwareDevice device;
    return front_of(traverser.draw_frame(view, device, options_of(tolerance_px)));
  }
  std::size_t lost_px(const Front& front, const View& view, double tolerance_px) const {
    HlodReference reference(placed, options_of(tolerance_px), nullptr);
    reference.set_view(view, view);
    return reference.compare(front, front).wrongly_hidden_px;
  }
  static hlod::TraverseOptions options_of(double tolerance_px) {
    hlod::TraverseOptions options;
    options.strategy = hlod::Strategy::vfc;
    options.tolerance_px = tolerance_px;
    return options;
  }

  hlod::Hlod hlod;
  std::vector<hlod::PlacedHlod> placed{{&hlod}};
};

constexpr double tolerances_px[] = {0.0, 1.0, 2.0, 4.0};

TEST(HlodReference, SimplificationWithinTheToleranceLosesNothing) {
  const TriangleMesh meshes[] = {test::noisy_sphere(6, 1), generate("city", {{"blocks", 2}, {"facade_cells", 8}}),
                                 generate("pipes", {{"pipes", 16}})};
  const glm::dvec3 eyes[] = {{0.0, -2.5, 0.5}, {-60.0, -40.0, 90.0}, {2.2, 1.4, 1.8}};
  for (std::size_t i = 0; i < std::size(meshes); ++i) {
    const Case one(meshes[i]);
    const View view(camera_at(eyes[i], 1000.0));
    for (const double tolerance_px : tolerances_px) {
      const Front front = one.front(view, tolerance_px);
      EXPECT_GT(front.draws.size(), 0U);
      EXPECT_EQ(one.lost_px(front, view, tolerance_px), 0U) << "mesh " << i << " at " << tolerance_px << " px";
    }
  }
}

// The picture of a node in front is many pixels wide; behind it is only the far side of the sphere, some 2 units
// farther.
TEST(HlodReference, ANodeThatIsHiddenWronglyCounts) {
  const Case sphere(test::noisy_sphere(6, 1));
  const View view(camera_at({0.0, -2.5, 0.0}));
  for (const double tolerance_px : tolerances_px) {
    Front front = sphere.front(view, tolerance_px);
    const auto nearest = std::min_element(front.draws.begin(), front.draws.end(), [&](const auto& a, const auto& b) {
      return sphere.hlod.node(a.node).sphere.center.y < sphere.hlod.node(b.node).sphere.center.y;
    });
    front.draws.erase(nearest);
    EXPECT_GT(sphere.lost_px(front, view, tolerance_px), 20U) << tolerance_px << " px";
  }
}

// Boxes that do not hold what a node stands for make vfc lose it; so the reference must not ask them.
TEST(HlodReference, WhatVfcItselfLosesCounts) {
  const Case sphere(test::noisy_sphere(6, 1));
  const View view(camera_at({0.0, -2.5, 0.0}));
  for (hlod::NodeId n = 0; n < sphere.hlod.node_count(); ++n) {
    auto& node = const_cast<hlod::Node&>(sphere.hlod.node(n));  // NOLINT: the fault that is planted
    node.box = node.lod_box = {glm::vec3(50.0F), glm::vec3(51.0F)};
    node.sphere.center = glm::vec3(50.5F);
  }
  for (const double tolerance_px : tolerances_px) {
    const Front front = sphere.front(view, tolerance_px);
    EXPECT_EQ(front.draws.size(), 0U);
    EXPECT_GT(sphere.lost_px(front, view, tolerance_px), 1000U) << tolerance_px << " px";
  }
}

// Nodes beyond the far plane are culled, and our rasteriser would draw those of the input.
TEST(HlodReference, WhatIsBeyondTheFarPlaneDoesNotCount) {
  const Case city(generate("city", {{"blocks", 4}, {"facade_cells", 4}}));
  Camera camera = camera_at({-60.0, -40.0, 90.0}, 250.0);
  camera.target = {120.0, 120.0, 0.0};  // 257 away
  const View view(camera);
  for (const double tolerance_px : tolerances_px)
    EXPECT_EQ(city.lost_px(city.front(view, tolerance_px), view, tolerance_px), 0U) << tolerance_px << " px";
}

// The vertices of a unit sphere are its normals, and those of all levels are near it.
TEST(InputNormals, AreThoseOfTheInputAtAllNodes) {
  const Case sphere(generate("rough-planet", {{"level", 4}, {"amplitude", 0}}));
  const InputNormals normals(sphere.placed);
  std::size_t levels = 0;
  for (hlod::NodeId n = 0; n < sphere.hlod.node_count(); ++n) {
    levels = std::max(levels, static_cast<std::size_t>(sphere.hlod.node(n).level) + 1);
    for (const glm::vec3& p : sphere.hlod.mesh(n).positions)
      EXPECT_GT(glm::dot(normals.at(0, p), glm::normalize(glm::dvec3(p))),
                sphere.hlod.node(n).level == 0 ? 0.999 : 0.9);
  }
  EXPECT_GT(levels, 2U);
  EXPECT_EQ(normals.at(0, glm::vec3(7.0F)), glm::dvec3(0.0));
}

}  // namespace
}  // namespace occlod::tool
