// Bounds of subtrees against the faces that their splits change: nothing lies outside, and cylinders fit as well as any
// along their axes. Written without the builder's own walk over stars.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <vector>

#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "occlod/mesh_file.h"
#include "support/meshes.h"
#include "support/test_meshes.h"

namespace occlod {
namespace {

// Calls visit(split, vertices) for every split: the corners of all faces that it and the splits below it change.
template <typename Visit>
void for_each_subtree(const Hierarchy& hierarchy, const Visit& visit) {
  const auto splits = static_cast<SplitId>(hierarchy.split_count());
  std::vector<std::vector<VertexId>> below(splits);
  for (SplitId s = splits; s-- > 0;) {
    std::vector<VertexId>& vertices = below[s];
    const SplitFaces faces = hierarchy.faces_of(s);
    for (const auto* list : {&faces.inserted, &faces.removed})
      for (const Triangle& t : *list) vertices.insert(vertices.end(), {t.x, t.y, t.z});
    for (const SplitId child : {hierarchy.node(s).child_u, hierarchy.node(s).child_v})
      if (child != no_id) {
        vertices.insert(vertices.end(), below[child].begin(), below[child].end());
        std::vector<VertexId>().swap(below[child]);
      }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    visit(s, vertices);
  }
}

struct Fit {
  double radius = 0.0, t_min = std::numeric_limits<double>::max(), t_max = std::numeric_limits<double>::lowest();
  [[nodiscard]] double volume() const { return glm::pi<double>() * radius * radius * (t_max - t_min); }
};

// Returns the smallest cylinder around the line of this one.
Fit fit(const Hierarchy& hierarchy, const std::vector<VertexId>& vertices, const Cylinder& cylinder) {
  Fit result;
  const glm::dvec3 axis = glm::normalize(glm::dvec3(cylinder.axis));
  for (const VertexId v : vertices) {
    const glm::dvec3 offset = glm::dvec3(hierarchy.positions()[v]) - glm::dvec3(cylinder.center);
    const double t = glm::dot(offset, axis);
    result.radius = std::max(result.radius, glm::length(offset - t * axis));
    result.t_min = std::min(result.t_min, t);
    result.t_max = std::max(result.t_max, t);
  }
  return result;
}

// Nothing outside any bound, and cylinders with at most 1.3 times the volume of the smallest ones in the geometric
// mean. Where the points are flat, packing (heights in steps of 1/32768 of the radius) makes all of the height.
void expect_fitting_bounds(const Hierarchy& hierarchy) {
  std::size_t outside = 0, measured = 0;
  double log_ratio = 0.0;
  for_each_subtree(hierarchy, [&](SplitId s, const std::vector<VertexId>& vertices) {
    const SplitNode& node = hierarchy.node(s);
    const Cylinder cylinder = node.cylinder();
    const Box box = node.box();
    for (const VertexId v : vertices) {
      const glm::vec3 p = hierarchy.positions()[v];
      const bool in_box = glm::min(p, box.min) == box.min && glm::max(p, box.max) == box.max;
      const bool in_sphere = glm::distance(glm::dvec3(p), glm::dvec3(node.sphere.center)) <= node.sphere.radius;
      if (!in_box || !in_sphere) ++outside;
    }
    const Fit best = fit(hierarchy, vertices, cylinder);
    if (best.radius > cylinder.radius || best.t_min < cylinder.t_min || best.t_max > cylinder.t_max) ++outside;
    if (best.t_max - best.t_min < 1e-3 * best.radius) return;
    const double radius = cylinder.radius, height = static_cast<double>(cylinder.t_max) - cylinder.t_min;
    log_ratio += std::log(glm::pi<double>() * radius * radius * height / best.volume());
    ++measured;
  });
  EXPECT_EQ(outside, 0U);
  ASSERT_GT(measured, hierarchy.split_count() / 2);
  EXPECT_LE(std::exp(log_ratio / static_cast<double>(measured)), 1.3);
}

TEST(SubtreeBounds, FitTheCornersOfTheirStars) {
  for (const TriangleMesh& mesh :
       {test::noisy_sphere(4, 1), test::torus(40, 30), test::two_components(), test::book(5)})
    if (const Hierarchy hierarchy = build_hierarchy(mesh); hierarchy.split_count() > 100)
      expect_fitting_bounds(hierarchy);
}

// Has subtrees too large to be fitted to their corners, and more splits than a thread bounds at a time.
TEST(SubtreeBounds, FitLargeSubtrees) {
  expect_fitting_bounds(build_hierarchy(generate("rough-planet", {{"level", 6}})));
}

TEST(SubtreeBounds, FitRealMeshes) {
  for (const char* name : {"scans/armadillo_100k.obj", "scans/fandisk.obj", "scenes/sponza.obj"}) {
    const auto path = test::find_test_mesh(name);
    if (!path) GTEST_SKIP() << "SKIPPED: " << name << " is in no folder of OCCLOD_MESHES";
    SCOPED_TRACE(name);
    expect_fitting_bounds(build_hierarchy(read_mesh(*path).mesh));
  }
}

// All faces lie in one plane, so the cylinders are discs. What is left of the height: the packed axis is off by up to
// 1/65535 in each of two directions, heights are packed in steps of 2/65535 of the radius and rounded outwards twice,
// and rounding adds 4e-6 of the radius on each side.
TEST(SubtreeBounds, FlatStarsHaveFlatCylinders) {
  TriangleMesh mesh = test::grid(20, 20);
  for (const bool tilted : {false, true}) {
    if (tilted)
      for (glm::vec3& p : mesh.positions) p = {p.x, p.y, 3.0F * p.x - 2.0F * p.y};
    const Hierarchy hierarchy = build_hierarchy(mesh);
    ASSERT_GT(hierarchy.split_count(), 300U);
    for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
      const Cylinder cylinder = hierarchy.node(s).cylinder();
      EXPECT_LE(cylinder.t_max - cylinder.t_min, 2e-4F * hierarchy.node(s).sphere.radius) << s;
    }
  }
}

}  // namespace
}  // namespace occlod
