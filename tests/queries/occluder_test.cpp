#include "refine/occluder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <random>

#include "occlod/generate.h"
#include "oracle/ray_scene.h"
#include "refine/refine_support.h"
#include "support/holed_meshes.h"

namespace occlod {
namespace {

struct Count {
  int hidden = 0;  // rays on which the occluder hides what is behind it
  int wrong = 0;   // of these, those on which the input has nothing in front of that
};

struct Sweep {
  OccluderMode mode = OccluderMode::conservative;
  bool two_sided = false;
  ErrorBound error_bound = ErrorBound::accumulated;
  double from_above = 0.0;  // added to the z of all directions in which the eye may be: 0 = from all around
  bool orthographic = false;
};

// The first splits, then more in random places, so many that a cut of `triangles` comes out.
void refine_randomly(CutSet& cuts, std::size_t triangles, std::mt19937& random) {
  const Hierarchy& hierarchy = cuts.hierarchy(0);
  const auto apply = [&](SplitId s) {
    if (cuts[0].applied(s)) return;
    (void)cuts.closure(0, s);
    cuts.apply_closure(0);
  };
  for (SplitId s = 0; cuts.triangle_count() < triangles / 2 && s < hierarchy.split_count(); ++s) apply(s);
  while (cuts.triangle_count() < triangles && cuts.triangle_count() < hierarchy.input_triangle_count())
    apply(static_cast<SplitId>(random() % hierarchy.split_count()));
}

// Random cuts of a mesh of about unit size around the origin. Rays go anywhere, not through the centres of pixels.
Count count_wrongly_hidden(const TriangleMesh& mesh, const Sweep& sweep) {
  const Hierarchy hierarchy = build_hierarchy(mesh, {.error_bound = sweep.error_bound});
  const test::RayScene input_rays(mesh.positions, mesh.triangles);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))); };
  Occluder occluder;
  Count count;
  for (int n = 0; n < 12; ++n) {
    CutSet cuts;
    cuts.add(hierarchy);
    const double share = (n + 1) / 12.0;
    refine_randomly(cuts, static_cast<std::size_t>(share * share * static_cast<double>(mesh.triangle_count())), random);
    Camera camera;
    camera.eye = 3.0 * glm::normalize(direction() + glm::dvec3(0.0, 0.0, sweep.from_above));
    camera.up = {0.3, 0.9, 0.2};
    if (sweep.orthographic) camera.orthographic_height = 2.5;
    const View view(camera);
    const std::vector<ObjectView> views = {ObjectView(view, glm::dmat4(1.0))};
    const std::vector<RefineObject> objects = {{&hierarchy, glm::dmat4(1.0), sweep.two_sided}};
    const std::span<const OccluderPart> parts = occluder.build(objects, cuts, view, views, sweep.mode);
    const test::RayScene occluder_rays(parts[0].positions, parts[0].triangles);
    for (int i = 0; i < 5000; ++i) {
      const glm::dvec3 target = 1.05 * direction();
      const glm::dvec3 ray = sweep.orthographic ? view.direction() : glm::normalize(target - camera.eye);
      const glm::dvec3 from = sweep.orthographic ? target - 3.0 * ray : camera.eye;
      const double hit = occluder_rays.first_hit(from, ray);
      if (!std::isfinite(hit)) continue;
      ++count.hidden;
      if (input_rays.first_hit(from, ray) > hit + 1e-6) ++count.wrong;
    }
  }
  return count;
}

Sweep with(Sweep sweep, OccluderMode mode) {
  sweep.mode = mode;
  return sweep;
}

// What the occluder hides along a ray has to be behind the input there, whatever the bounds of the hierarchy are.
// Coarse triangles as they are bulge out.
void expect_conservative(const TriangleMesh& mesh, Sweep sweep, int min_hidden) {
  for (const ErrorBound error_bound : {ErrorBound::accumulated, ErrorBound::measured}) {
    sweep.error_bound = error_bound;
    const Count conservative = count_wrongly_hidden(mesh, sweep);
    EXPECT_EQ(conservative.wrong, 0);
    EXPECT_GT(conservative.hidden, min_hidden);  // and is an occluder still
    EXPECT_GT(count_wrongly_hidden(mesh, with(sweep, OccluderMode::paper)).wrong, 20);
  }
}

TEST(ConservativeOccluder, Ball) { expect_conservative(test::noisy_sphere(4, 6), {}, 10'000); }
TEST(ConservativeOccluder, BallInParallelProjection) {
  expect_conservative(test::noisy_sphere(4, 6), {.orthographic = true}, 10'000);
}

// Long and narrow, and thin.
TEST(ConservativeOccluder, Pipes) {
  TriangleMesh mesh = generate("pipes", {{"pipes", 12}, {"bends", 8}, {"sides", 8}});
  for (glm::vec3& p : mesh.positions) p = 2.0F * p - 1.0F;
  expect_conservative(mesh, {}, 0);
}

// Seen from either side: near its borders the coarse sheet hides what is seen past the fine one; and it closes windows.
constexpr Sweep sheet{.two_sided = true, .from_above = 3.0};
TEST(ConservativeOccluder, SheetWithWindows) { expect_conservative(test::sheet_with_windows(), sheet, 500); }

TEST(ConservativeOccluder, BlockWithTunnels) { expect_conservative(test::block(true), {.from_above = 2.0}, 500); }
TEST(ConservativeOccluder, BlockWithGrooves) { expect_conservative(test::block(false), {.from_above = 1.0}, 500); }

// Some cut of a sphere, and the occluder that is made of it as it is.
struct SphereCut {
  explicit SphereCut(const glm::dmat4& object_to_world, bool two_sided = false)
      : hierarchy(build_hierarchy(test::noisy_sphere(3, 1))), views{{View(test::front_camera()), object_to_world}} {
    cuts.add(hierarchy);
    (void)cuts.closure(0, static_cast<SplitId>(hierarchy.split_count() / 2));
    cuts.apply_closure(0);
    const std::vector<RefineObject> objects = {{&hierarchy, object_to_world, two_sided}};
    part = occluder.build(objects, cuts, View(test::front_camera()), views, OccluderMode::paper).front();
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

}  // namespace
}  // namespace occlod
