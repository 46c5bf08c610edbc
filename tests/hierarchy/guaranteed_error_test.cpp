// The promise of the guaranteed error, measured: no cut is further from the input than it says.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <random>

#include "occlod/hierarchy/build.h"
#include "occlod/hierarchy/cut_mesh.h"
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

// The largest distance of random points on `from` to `to`.
double sampled_distance(std::span<const glm::vec3> positions, const std::vector<Triangle>& from,
                        const std::vector<Triangle>& to, int samples_per_triangle, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double largest = 0.0;
  for (const Triangle& t : from)
    for (int i = 0; i < samples_per_triangle; ++i) {
      double s = unit(random), r = unit(random);
      if (s + r > 1.0) s = 1.0 - s, r = 1.0 - r;
      const glm::dvec3 a(positions[t.x]), b(positions[t.y]), c(positions[t.z]);
      const glm::dvec3 p = a + s * (b - a) + r * (c - a);
      double nearest = std::numeric_limits<double>::max();
      for (const Triangle& q : to)
        nearest = std::min(nearest, distance_to_triangle(p, glm::dvec3(positions[q.x]), glm::dvec3(positions[q.y]),
                                                         glm::dvec3(positions[q.z])));
      largest = std::max(largest, nearest);
    }
  return largest;
}

void expect_promise_kept(const TriangleMesh& mesh, std::size_t base_triangles) {
  BuildOptions options;
  options.base_triangles = base_triangles;
  const Hierarchy hierarchy = build_hierarchy(mesh, options);
  const std::vector<Triangle> input = triangles_of(hierarchy, full_cut(hierarchy));
  std::mt19937 random(1);
  const auto splits = static_cast<SplitId>(hierarchy.split_count());
  for (int step = 0; step < 6; ++step) {
    const SplitId applied = splits * static_cast<SplitId>(step) / 6;  // the first so many: closed under dependency
    FixedCut cut_splits{std::vector<bool>(splits, false)};
    std::fill_n(cut_splits.applied.begin(), applied, true);
    const std::vector<Triangle> cut = triangles_of(hierarchy, cut_splits);
    double promised = 0.0;
    for (SplitId s = applied; s < splits; ++s)
      promised = std::max(promised, static_cast<double>(hierarchy.node(s).guaranteed_error));
    const double there = sampled_distance(hierarchy.positions(), input, cut, 1, random);
    const double back = sampled_distance(hierarchy.positions(), cut, input, 4, random);
    EXPECT_LE(there, promised) << "after " << applied << " of " << splits << " splits";
    EXPECT_LE(back, promised) << "after " << applied << " of " << splits << " splits";
    EXPECT_GT(there, 0.02 * promised) << "a promise as loose as this says nothing";
  }
}

TEST(GuaranteedError, HoldsOnAClosedSurface) { expect_promise_kept(test::noisy_sphere(4, 5), 40); }

TEST(GuaranteedError, HoldsOnATorus) { expect_promise_kept(test::torus(32, 16), 40); }

TEST(GuaranteedError, HoldsOnASurfaceWithBoundary) {
  TriangleMesh hills = test::grid(20, 20);
  for (glm::vec3& p : hills.positions) p.z = 0.1F * glm::sin(9.0F * p.x) * glm::cos(7.0F * p.y + p.x);
  expect_promise_kept(hills, 20);
}

}  // namespace
}  // namespace occlod
