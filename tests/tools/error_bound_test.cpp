// What hierarchies promise (SplitNode::guaranteed_error) against distances that CGAL's tree measures.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "measure/surface_distance.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "occlod/mesh_file.h"
#include "support/test_meshes.h"

namespace occlod::measure {
namespace {

// No cut is farther from the input than it promises, at ten tolerances of 0.01 to 10 % of the diagonal; and in the
// median it promises at most three times the distance.
void expect_tight(const TriangleMesh& mesh) {
  BuildOptions options;
  options.error_bound = ErrorBound::measured;
  const Hierarchy hierarchy = build_hierarchy(mesh, options);
  const Surface input(mesh.positions, mesh.triangles);
  std::vector<double> ratios;
  for (const double percent : {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0}) {
    const FixedCut cut = cut_to_error(hierarchy, percent / 100.0 * input.diagonal());
    if (!(cut.guaranteed_error > 0.0F)) continue;  // nothing is left out
    const TriangleMesh coarse = cut_mesh(hierarchy, cut);
    const double measured =
        surface_distance(input, Surface(coarse.positions, coarse.triangles), {20'000, 1}).farther().max;
    EXPECT_LE(measured, cut.guaranteed_error) << "at " << percent << " %, " << cut.triangles << " triangles";
    ratios.push_back(cut.guaranteed_error / measured);
  }
  ASSERT_GE(ratios.size(), 5U);
  std::sort(ratios.begin(), ratios.end());
  EXPECT_LE(ratios[ratios.size() / 2], 3.0);
}

TEST(ErrorBound, IsTightOnAPlanet) { expect_tight(generate("rough-planet", {{"level", 6}})); }

class ErrorBoundOfScan : public testing::TestWithParam<const char*> {};

TEST_P(ErrorBoundOfScan, IsTight) {
  OCCLOD_FIND_TEST_MESH_OR_SKIP(path, GetParam());
  expect_tight(read_mesh(path).mesh);
}

INSTANTIATE_TEST_SUITE_P(Scans, ErrorBoundOfScan,
                         testing::Values("scans/armadillo_100k.obj", "scans/bun_zipper.ply",
                                         "scans/dragon_vrip_res3.ply", "scans/fandisk.obj", "scans/gargo.ply",
                                         "scans/horse.ply"));

}  // namespace
}  // namespace occlod::measure
