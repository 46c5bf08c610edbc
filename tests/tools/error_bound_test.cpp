// What hierarchies and HLODs promise (guaranteed_error) against distances that CGAL's tree measures.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "measure/surface_distance.h"
#include "occlod/build_hierarchy.h"
#include "occlod/build_hlod.h"
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

// The meshes of nodes, one after the other.
struct Nodes {
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;

  void add(const hlod::NodeMesh& mesh) {
    const auto first = static_cast<VertexId>(positions.size());
    positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
      triangles.push_back(Triangle(mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]) + first);
  }
};

// No point of a node is farther from the input than the node promises, and no point of the input farther from a level
// than its worst node promises; that is at most five times the distance, where accumulated bounds promise more.
void expect_tight_nodes(const TriangleMesh& mesh, hlod::HlodBuildOptions options) {
  options.node_triangles = 256;
  const hlod::Hlod accumulated = build_hlod(mesh, options);
  options.error_bound = ErrorBound::measured;
  const hlod::Hlod hlod = build_hlod(mesh, options);
  ASSERT_EQ(hlod.node_count(), accumulated.node_count());
  const std::vector<std::string> violations = validate(hlod);
  EXPECT_TRUE(violations.empty()) << violations[0];
  const Surface input(mesh.positions, mesh.triangles);
  const double rounding = 1e-12 * input.diagonal();  // of what is measured: some nodes promise 0
  for (std::size_t level = 1; level < hlod.level_count(); ++level) {
    const hlod::Level& range = hlod.data().levels[level];
    Nodes all;
    float promised = 0.0F, added_up = 0.0F;
    double farthest = 0.0;
    for (hlod::NodeId n = range.first_node; n < range.first_node + range.node_count; ++n) {
      if (hlod.node(n).triangles == 0) continue;
      Nodes one;
      one.add(hlod.mesh(n));
      all.add(hlod.mesh(n));
      const double distance = one_way_distance(Surface(one.positions, one.triangles), input, {4'000, 1}).max;
      EXPECT_LE(distance, hlod.node(n).guaranteed_error + rounding) << "node " << n << " of level " << level;
      EXPECT_LE(hlod.node(n).guaranteed_error, accumulated.node(n).guaranteed_error) << n;
      promised = std::max(promised, hlod.node(n).guaranteed_error);
      added_up = std::max(added_up, accumulated.node(n).guaranteed_error);
      farthest = std::max(farthest, distance);
    }
    const double back = one_way_distance(input, Surface(all.positions, all.triangles), {50'000, 1}).max;
    // The coarsest lose whole limbs that free borders have parted from the rest, which count with their extent.
    if (all.triangles.size() > 200) {
      EXPECT_LE(back, promised) << "level " << level;
    }
    EXPECT_LE(promised, 5.0 * std::max(back, farthest)) << "level " << level;
    EXPECT_LT(promised, added_up) << "level " << level;
  }
}

TEST(ErrorBound, OfNodesIsTightOnAPlanet) {
  const TriangleMesh planet = generate("rough-planet", {{"level", 6}});
  expect_tight_nodes(planet, {});
  expect_tight_nodes(planet, {.grouping = hlod::Grouping::nested, .borders = hlod::Borders::free});
}

TEST_P(ErrorBoundOfScan, OfNodesIsTight) {
  OCCLOD_FIND_TEST_MESH_OR_SKIP(path, GetParam());
  expect_tight_nodes(read_mesh(path).mesh, {.grouping = hlod::Grouping::nested, .borders = hlod::Borders::free});
}

}  // namespace
}  // namespace occlod::measure
