// The promise of the guaranteed error, measured: no cut is further from the input than it says.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <random>

#include "occlod/build_hierarchy.h"
#include "splits/star.h"
#include "support/meshes.h"

namespace occlod {
namespace {

// Ericson, Real-Time Collision Detection, sec. 5.1.5.
double distance_to_triangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return glm::distance(p, a);
  const double d3 = glm::dot(ab, p - b), d4 = glm::dot(ac, p - b);
  if (d3 >= 0 && d4 <= d3) return glm::distance(p, b);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return glm::distance(p, a + d1 / (d1 - d3) * ab);
  const double d5 = glm::dot(ab, p - c), d6 = glm::dot(ac, p - c);
  if (d6 >= 0 && d5 <= d6) return glm::distance(p, c);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return glm::distance(p, a + d2 / (d2 - d6) * ac);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return glm::distance(p, b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b));
  const double sum = va + vb + vc;
  return glm::distance(p, a + vb / sum * ab + vc / sum * ac);
}

// The largest distance from `to` of random points on `from` and of its corners.
double sampled_distance(std::span<const glm::vec3> positions, const std::vector<Triangle>& from,
                        const std::vector<Triangle>& to, int samples_per_triangle, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double largest = 0.0;
  const auto look_at = [&](const glm::dvec3& p) {
    double nearest = std::numeric_limits<double>::max();
    for (const Triangle& q : to)
      nearest = std::min(nearest, distance_to_triangle(p, glm::dvec3(positions[q.x]), glm::dvec3(positions[q.y]),
                                                       glm::dvec3(positions[q.z])));
    largest = std::max(largest, nearest);
  };
  for (const Triangle& t : from) {
    const glm::dvec3 a(positions[t.x]), b(positions[t.y]), c(positions[t.z]);
    look_at(a);
    for (int i = 0; i < samples_per_triangle; ++i) {
      double s = unit(random), r = unit(random);
      if (s + r > 1.0) s = 1.0 - s, r = 1.0 - r;
      look_at(a + s * (b - a) + r * (c - a));
    }
  }
  return largest;
}

// Random splits and all that they depend on: a cut that is no step of the simplification.
FixedCut random_cut(const Hierarchy& hierarchy, double share, std::mt19937& random) {
  FixedCut cut;
  cut.applied.assign(hierarchy.split_count(), false);
  std::bernoulli_distribution is_chosen(share);
  for (auto s = static_cast<SplitId>(hierarchy.split_count()); s-- > 0;) {
    if (!cut.applied[s]) cut.applied[s] = is_chosen(random);
    if (cut.applied[s])
      for (const SplitId needed : star_of(hierarchy, s).dependencies()) cut.applied[needed] = true;
    else
      cut.guaranteed_error = std::max(cut.guaranteed_error, hierarchy.node(s).guaranteed_error);
  }
  return cut;
}

struct Distances {
  double there = 0.0, back = 0.0;
};

Distances distances_of(const Hierarchy& hierarchy, const FixedCut& cut, std::mt19937& random) {
  const std::vector<Triangle> input = triangles_of(hierarchy, full_cut(hierarchy));
  const std::vector<Triangle> coarse = triangles_of(hierarchy, cut);
  return {sampled_distance(hierarchy.positions(), input, coarse, 1, random),
          sampled_distance(hierarchy.positions(), coarse, input, 4, random)};
}

BuildOptions options_for(ErrorBound bound, std::size_t base_triangles) {
  BuildOptions options;
  options.base_triangles = base_triangles;
  options.error_bound = bound;
  return options;
}

// Whatever the cut, no point of it is farther from the input than the largest promise of what is not applied, nor the
// other way round.
void expect_promise_kept(const TriangleMesh& mesh, std::size_t base_triangles) {
  for (const ErrorBound bound : {ErrorBound::accumulated, ErrorBound::measured}) {
    const Hierarchy hierarchy = build_hierarchy(mesh, options_for(bound, base_triangles));
    std::mt19937 random(1);
    const auto expect_kept = [&](const FixedCut& cut) {
      const Distances distances = distances_of(hierarchy, cut, random);
      EXPECT_LE(distances.there, cut.guaranteed_error);
      EXPECT_LE(distances.back, cut.guaranteed_error);
    };
    for (const double share : {0.0, 0.001, 0.01, 0.1, 0.5}) expect_kept(random_cut(hierarchy, share, random));
    for (const double share : {0.1, 0.3, 0.6, 0.9})
      expect_kept(cut_to_error(hierarchy, share * hierarchy.error_bound()));
  }
}

TEST(GuaranteedError, HoldsOnAClosedSurface) { expect_promise_kept(test::noisy_sphere(4, 5), 40); }

TEST(GuaranteedError, HoldsOnATorus) { expect_promise_kept(test::torus(32, 16), 40); }

TriangleMesh hills(int n) {
  TriangleMesh mesh = test::grid(n, n);
  for (glm::vec3& p : mesh.positions) p.z = 0.1F * glm::sin(9.0F * p.x) * glm::cos(7.0F * p.y + p.x);
  return mesh;
}

TEST(GuaranteedError, HoldsOnASurfaceWithBoundary) { expect_promise_kept(hills(20), 20); }

TEST(GuaranteedError, HoldsWhereSheetsMeetAndBordersCrumble) {
  TriangleMesh mesh = hills(12);
  TriangleMesh upright = hills(12);  // a second sheet that shares the vertices of the row y = 0
  for (glm::vec3& p : upright.positions) std::swap(p.y, p.z);
  const auto first = static_cast<VertexId>(mesh.positions.size());
  test::append(mesh, upright, glm::vec3(0.0F));
  for (Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      if (t[k] >= first && t[k] < first + 13) t[k] -= first;
  expect_promise_kept(mesh, 12);
  expect_promise_kept(test::moebius(60), 6);
}

// Small thin triangles, each with its tip in a vertex of a sheet, collapse into their far edge and vanish long before
// the sheet moves as far: their errors have to go on growing with it.
TEST(GuaranteedError, HoldsWhereWhatVanishesHangsByACorner) {
  TriangleMesh mesh = hills(12);
  const auto vertices = static_cast<VertexId>(mesh.vertex_count());
  for (VertexId v = 0; v < vertices; v += 3) {
    const auto first = static_cast<VertexId>(mesh.vertex_count());
    const glm::vec3 tip = mesh.positions[v];
    const float height = v % 2 == 0 ? 0.06F : -0.06F;
    mesh.positions.insert(mesh.positions.end(), {tip + glm::vec3(0, 0, height), tip + glm::vec3(0.001F, 0, height)});
    mesh.triangles.emplace_back(v, first, first + 1);
  }
  expect_promise_kept(mesh, 8);
}

// One triangle is as large as hundreds of the others, one has no area.
TEST(GuaranteedError, HoldsOnUnevenTriangles) {
  TriangleMesh mesh = hills(16);
  const auto first = static_cast<VertexId>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{0.0F, -3.0F, 0.2F}, {0.5F, -1.5F, 0.1F}, {1.0F, 0.0F, 0.0F}});
  mesh.triangles.push_back({0, first, 16});
  mesh.triangles.push_back({first, first + 1, first + 2});
  expect_promise_kept(mesh, 8);
}

// Every collapse inside a plane leaves it as it is: the only bound that says so is zero, and what rounding adds.
TEST(GuaranteedError, IsZeroInAPlane) {
  for (const ErrorBound bound : {ErrorBound::accumulated, ErrorBound::measured})
    EXPECT_LT(build_hierarchy(test::grid(24, 24), options_for(bound, 2)).error_bound(), 1e-5F);
}

// The tip of a spike of height 1 over a plane with cells of 1/16: a cut without it is a plane, or has a slope from some
// vertex of it, and is at least 0.9 away from the tip. The two promises may not be less.
TEST(GuaranteedError, CoversASpike) {
  TriangleMesh mesh = test::grid(16, 16);
  const VertexId tip = 8 * 17 + 8;
  mesh.positions[tip].z = 1.0F;
  const Hierarchy hierarchy = build_hierarchy(mesh, options_for(ErrorBound::measured, 2));
  const auto positions = hierarchy.positions();
  const auto at = static_cast<VertexId>(
      std::find_if(positions.begin(), positions.end(), [](const glm::vec3& p) { return p.z == 1.0F; }) -
      positions.begin());
  ASSERT_GE(at, hierarchy.base_vertex_count()) << "the base holds the spike";
  EXPECT_GE(hierarchy.node(static_cast<SplitId>(at - hierarchy.base_vertex_count())).guaranteed_error, 0.9F);
}

// A copy of the triangles a long way from the origin: positions are coarse there, and promises have to know.
TEST(GuaranteedError, HoldsFarFromTheOrigin) {
  TriangleMesh mesh = test::noisy_sphere(3, 2);
  for (glm::vec3& p : mesh.positions) p += glm::vec3(1000.0F, -2000.0F, 500.0F);
  expect_promise_kept(mesh, 20);
}

// What measuring is for. tests/tools/error_bound_test.cpp compares it with distances.
TEST(GuaranteedError, MeasuredIsTighterOnCoarseMeshes) {
  const TriangleMesh mesh = test::noisy_sphere(5, 7);
  EXPECT_LT(build_hierarchy(mesh, options_for(ErrorBound::measured, 32)).error_bound(),
            0.5F * build_hierarchy(mesh, options_for(ErrorBound::accumulated, 32)).error_bound());
}

TEST(GuaranteedError, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh mesh = test::noisy_sphere(6, 3);
  BuildOptions options = options_for(ErrorBound::measured, 64);
  options.threads = 1;
  const Hierarchy one = build_hierarchy(mesh, options);
  options.threads = 3;
  const Hierarchy three = build_hierarchy(mesh, options);
  ASSERT_EQ(one.split_count(), three.split_count());
  for (SplitId s = 0; s < one.split_count(); ++s)
    ASSERT_EQ(one.node(s).guaranteed_error, three.node(s).guaranteed_error) << "split " << s;
}

}  // namespace
}  // namespace occlod
