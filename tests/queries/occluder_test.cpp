#include "queries/occluder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <random>

#include "occlod/mesh/clean.h"
#include "occlod/mesh/generate.h"
#include "oracle/ray_scene.h"
#include "refine/refine_support.h"

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
  Occluder::Without without{};
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
  Occluder occluder(sweep.without);
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
void expect_conservative(const TriangleMesh& mesh, Sweep sweep, int least_hidden) {
  for (const ErrorBound error_bound : {ErrorBound::accumulated, ErrorBound::measured}) {
    sweep.error_bound = error_bound;
    const Count conservative = count_wrongly_hidden(mesh, sweep);
    EXPECT_EQ(conservative.wrong, 0);
    EXPECT_GT(conservative.hidden, least_hidden);  // and is an occluder still
    EXPECT_GT(count_wrongly_hidden(mesh, with(sweep, OccluderMode::paper)).wrong, 20);
  }
}

TEST(ConservativeOccluder, Ball) { expect_conservative(test::noisy_sphere(4, 6), {}, 10'000); }
TEST(ConservativeOccluder, BallInParallelProjection) {
  expect_conservative(test::noisy_sphere(4, 6), {.orthographic = true}, 10'000);
}

// Long and narrow, and thin.
TEST(ConservativeOccluder, Pipes) {
  TriangleMesh mesh = generate_pipes({.pipes = 12, .bends = 8, .sides = 8});
  for (glm::vec3& p : mesh.positions) p = 2.0F * p - 1.0F;
  expect_conservative(mesh, {}, 0);
}

// A wavy sheet with windows, seen from either side: near its borders the coarse sheet hides what is seen past the fine
// one; and it closes windows.
TriangleMesh sheet_with_windows() {
  constexpr int cells = 48;
  TriangleMesh mesh = test::grid(cells, cells);
  for (glm::vec3& p : mesh.positions)
    p = {2.0F * p.x - 1.0F, 2.0F * p.y - 1.0F, 0.03F * std::sin(7.0F * p.x) * std::cos(9.0F * p.y)};
  const auto is_gone = [](float x) { return static_cast<int>(std::floor((x + 1.0F) * (cells / 2))) % 8 == 3; };
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const glm::vec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0F;
    return is_gone(middle.x) && is_gone(middle.y);
  });
  return clean(std::move(mesh), {}, "test").mesh;
}
constexpr Sweep sheet{.two_sided = true, .from_above = 3.0};

TEST(ConservativeOccluder, SheetWithWindows) { expect_conservative(sheet_with_windows(), sheet, 500); }

// A block with tunnels right through, or with grooves along its top and bottom.
TriangleMesh block(bool tunnels) {
  constexpr int cells = 40, layers = 4;
  constexpr float depth = 0.1F;
  TriangleMesh mesh;
  const auto is_solid = [&](int i, int j, int k) {
    if (std::min({i, j, k}) < 0 || std::max(i, j) >= cells || k >= layers) return false;
    if (tunnels) return i % 8 != 3 || j % 8 != 3;
    return i % 5 != 2 || (k > 0 && k < layers - 1);
  };
  const auto vertex = [&](const glm::ivec3& at) {
    const float x = 2.0F * static_cast<float>(at.x) / cells - 1.0F, y = 2.0F * static_cast<float>(at.y) / cells - 1.0F;
    mesh.positions.emplace_back(x, y,
                                depth * static_cast<float>(at.z) / layers + 0.01F * std::sin(3.0F * x + 2.0F * y));
    return static_cast<VertexId>(mesh.positions.size() - 1);
  };
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j)
      for (int k = 0; k < layers; ++k)
        for (int side = 0; side < 6 && is_solid(i, j, k); ++side) {
          const int axis = side / 2, sign = side % 2;
          glm::ivec3 out(0), u(0), v(0), at(i, j, k);
          out[axis] = 2 * sign - 1;
          if (is_solid(i + out.x, j + out.y, k + out.z)) continue;
          at[axis] += sign;
          u[(axis + 2 - sign) % 3] = v[(axis + 1 + sign) % 3] = 1;
          const VertexId a = vertex(at), b = vertex(at + u), c = vertex(at + u + v), d = vertex(at + v);
          mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
        }
  return clean(std::move(mesh), {}, "test").mesh;
}

TEST(ConservativeOccluder, BlockWithTunnels) { expect_conservative(block(true), {.from_above = 2.0}, 500); }
TEST(ConservativeOccluder, BlockWithGrooves) { expect_conservative(block(false), {.from_above = 1.0}, 500); }

// Each of the three remedies is needed.
TEST(ConservativeOccluder, IsWrongWithoutMotionBounds) {
  Sweep sweep = sheet;
  sweep.error_bound = ErrorBound::measured;
  sweep.without.motion = true;
  EXPECT_GT(count_wrongly_hidden(sheet_with_windows(), sweep).wrong, 0);
}
TEST(ConservativeOccluder, IsWrongWithoutMarks) {
  Sweep sweep = sheet;
  sweep.without.tiles.marks = true;
  EXPECT_GT(count_wrongly_hidden(sheet_with_windows(), sweep).wrong, 0);
}
TEST(ConservativeOccluder, IsWrongWithoutErosion) {
  EXPECT_GT(
      count_wrongly_hidden(
          block(false), {.without = {.motion = false, .tiles = {.marks = false, .erosion = true}}, .from_above = 1.0})
          .wrong,
      0);
}

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
