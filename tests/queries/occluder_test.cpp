#include "queries/occluder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <random>

#include "occlod/mesh/generate.h"
#include "oracle/ray_scene.h"
#include "refine/refine_support.h"

namespace occlod {
namespace {

struct Count {
  int hidden = 0;  // rays on which the occluder hides what is behind it
  int wrong = 0;   // of these, those on which the input has nothing in front of that
};

// Random cuts of a mesh of about unit size around the origin, looked at from all around.
Count count_wrongly_hidden(const TriangleMesh& mesh, OccluderMode mode, bool two_sided = false) {
  const Hierarchy hierarchy = build_hierarchy(mesh);
  const test::RayScene input_rays(mesh.positions, mesh.triangles);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))); };
  Occluder occluder;
  Count count;
  for (int n = 0; n < 12; ++n) {
    CutSet cuts;
    cuts.add(hierarchy);
    for (int i = 0; i < 20 * n; ++i) {
      const auto s = static_cast<SplitId>(random() % hierarchy.split_count());
      if (cuts[0].applied(s)) continue;
      (void)cuts.closure(0, s);
      cuts.apply_closure(0);
    }
    Camera camera;
    camera.eye = 3.0 * direction();
    const std::vector<ObjectView> views = {ObjectView(View(camera), glm::dmat4(1.0))};
    const std::vector<RefineObject> objects = {{&hierarchy, glm::dmat4(1.0), two_sided}};
    const std::span<const OccluderPart> parts = occluder.build(objects, cuts, views, mode);
    const test::RayScene occluder_rays(parts[0].positions, parts[0].triangles);
    for (int i = 0; i < 5000; ++i) {
      const glm::dvec3 ray = glm::normalize(1.05 * direction() - camera.eye);
      const double hit = occluder_rays.first_hit(camera.eye, ray);
      if (!std::isfinite(hit)) continue;
      ++count.hidden;
      if (input_rays.first_hit(camera.eye, ray) > hit + 1e-6) ++count.wrong;
    }
  }
  return count;
}

// What the occluder hides along a ray has to be behind the input there. Coarse triangles as they are bulge out.
TEST(Occluder, ConservativeHidesOnlyWhatTheInputHides) {
  const TriangleMesh mesh = test::noisy_sphere(4, 6);
  const Count conservative = count_wrongly_hidden(mesh, OccluderMode::conservative);
  EXPECT_EQ(conservative.wrong, 0);
  EXPECT_GT(conservative.hidden, 10'000);  // and is an occluder still
  EXPECT_GT(count_wrongly_hidden(mesh, OccluderMode::paper).wrong, 1000);
}

// Faces along a pipe are long and narrow. Moved back by more than the pipe is thick they would float behind it in the
// open, so they are no occluders until they are twice as wide as their error.
TEST(Occluder, ConservativeLeavesOutWhatIsThinnerThanItsError) {
  TriangleMesh mesh = generate_pipes({.pipes = 12, .bends = 8, .sides = 8});
  for (glm::vec3& p : mesh.positions) p = 2.0F * p - 1.0F;
  const Count conservative = count_wrongly_hidden(mesh, OccluderMode::conservative);
  EXPECT_EQ(conservative.wrong, 0);
  EXPECT_GT(conservative.hidden, 1000);
  EXPECT_GT(count_wrongly_hidden(mesh, OccluderMode::paper).wrong, 100);
}

// A wavy sheet with a hole in it, seen from either side: near its borders the coarse sheet hides what is seen past the
// fine one.
TEST(Occluder, ConservativeSheetsHideNothingAtTheirBorders) {
  TriangleMesh mesh = test::grid(40, 40);
  for (glm::vec3& p : mesh.positions)
    p = {2.0F * p.x - 1.0F, 2.0F * p.y - 1.0F, 0.05F * std::sin(11.0F * p.x) * std::cos(13.0F * p.y)};
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const glm::vec3& p = mesh.positions[t.x];
    return p.x * p.x + p.y * p.y < 0.1F;
  });
  const Count conservative = count_wrongly_hidden(mesh, OccluderMode::conservative, true);
  EXPECT_EQ(conservative.wrong, 0);
  EXPECT_GT(conservative.hidden, 500);
  EXPECT_GT(count_wrongly_hidden(mesh, OccluderMode::paper, true).wrong, 100);
}

// Some cut of a sphere, and the occluder that is made of it as it is.
struct SphereCut {
  explicit SphereCut(const glm::dmat4& object_to_world, bool two_sided = false)
      : hierarchy(build_hierarchy(test::noisy_sphere(3, 1))), views{{View(test::front_camera()), object_to_world}} {
    cuts.add(hierarchy);
    (void)cuts.closure(0, static_cast<SplitId>(hierarchy.split_count() / 2));
    cuts.apply_closure(0);
    const std::vector<RefineObject> objects = {{&hierarchy, object_to_world, two_sided}};
    part = occluder.build(objects, cuts, views, OccluderMode::paper).front();
    cuts.active_triangles(0, cut, false);
  }
  [[nodiscard]] float facing(const Triangle& t) const {
    const std::span<const glm::vec3> p = hierarchy.positions();
    return glm::dot(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]), views[0].eye() - p[t.x]);
  }

  Hierarchy hierarchy;
  CutSet cuts;
  std::vector<ObjectView> views;
  Occluder occluder;
  OccluderPart part;
  std::vector<Triangle> cut;
};

TEST(Occluder, OfTwoSidedObjectsIsTheCutItself) {
  const SphereCut sphere(glm::dmat4(1.0), true);
  ASSERT_EQ(sphere.part.triangles.size(), sphere.cut.size());
  for (std::size_t i = 0; i < sphere.cut.size(); ++i) EXPECT_EQ(sphere.part.triangles[i], sphere.cut[i]);
  EXPECT_EQ(sphere.part.positions.data(), sphere.hierarchy.positions().data());
}

// Also where the transform turns them inside out: what faces the eye does so in object space too.
TEST(Occluder, OthersShowTheirFronts) {
  glm::dmat4 mirror(1.0);
  mirror[0][0] = -1.0;
  for (const glm::dmat4& object_to_world : {glm::dmat4(1.0), mirror}) {
    const SphereCut sphere(object_to_world);
    std::vector<Triangle> fronts;
    std::copy_if(sphere.cut.begin(), sphere.cut.end(), std::back_inserter(fronts),
                 [&](const Triangle& t) { return !(sphere.facing(t) < 0.0F); });
    EXPECT_LT(fronts.size(), sphere.cut.size());
    ASSERT_EQ(sphere.part.triangles.size(), fronts.size());
    for (std::size_t i = 0; i < fronts.size(); ++i) EXPECT_EQ(sphere.part.triangles[i], fronts[i]);
  }
}

// The full mesh is the input: its error is 0, and its front faces are where they are.
TEST(Occluder, FrontOfTheFullMeshIsNotMoved) {
  const Hierarchy hierarchy = build_hierarchy(test::noisy_sphere(3, 1));
  CutSet cuts;
  cuts.add(hierarchy);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s)
    if (!cuts[0].applied(s)) {
      (void)cuts.closure(0, s);
      cuts.apply_closure(0);
    }
  const std::vector<ObjectView> views = {ObjectView(View(test::front_camera()), glm::dmat4(1.0))};
  Occluder occluder;
  const std::vector<RefineObject> objects = {{&hierarchy}};
  const std::span<const OccluderPart> parts = occluder.build(objects, cuts, views, OccluderMode::conservative);
  std::vector<glm::vec3> expected;
  std::vector<Triangle> cut;
  cuts.active_triangles(0, cut, true);
  for (const Triangle& t : cut) {
    const glm::vec3 &a = hierarchy.positions()[t.x], &b = hierarchy.positions()[t.y], &c = hierarchy.positions()[t.z];
    if (glm::dot(glm::cross(b - a, c - a), views[0].eye() - a) > 0.0F) expected.insert(expected.end(), {a, b, c});
  }
  EXPECT_TRUE(std::equal(parts[0].positions.begin(), parts[0].positions.end(), expected.begin(), expected.end()));
}

}  // namespace
}  // namespace occlod
