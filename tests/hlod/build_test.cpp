#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "hlod_bytes.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "occlod/hlod.h"
#include "splits/nearest_point.h"
#include "support/meshes.h"

namespace occlod::hlod {
namespace {

using occlod::test::noisy_sphere;

const std::vector<std::pair<Grouping, Borders>> all_kinds = {
    {Grouping::shifted, Borders::locked}, {Grouping::nested, Borders::locked}, {Grouping::nested, Borders::free}};

HlodBuildOptions small_nodes(Grouping grouping = Grouping::shifted, Borders borders = Borders::locked) {
  HlodBuildOptions options;
  options.node_triangles = 64;
  options.grouping = grouping;
  options.borders = borders;
  options.threads = 1;
  return options;
}

// Returns the root mean square of the distances from the vertices of a mesh to a level, by trying all triangles.
double rms_distance(const TriangleMesh& mesh, const Hlod& hlod, std::size_t level) {
  std::vector<std::array<glm::dvec3, 3>> faces;
  const Level& nodes = hlod.data().levels[level];
  for (NodeId n = nodes.first_node; n < nodes.first_node + nodes.node_count; ++n) {
    const NodeMesh node = hlod.mesh(n);
    for (std::size_t i = 0; i < node.indices.size(); i += 3)
      faces.push_back(
          {node.positions[node.indices[i]], node.positions[node.indices[i + 1]], node.positions[node.indices[i + 2]]});
  }
  double sum = 0.0;
  for (const glm::vec3& p : mesh.positions) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : faces) least = std::min(least, nearest_point(glm::dvec3(p), a, b, c).distance2);
    sum += least;
  }
  return std::sqrt(sum / static_cast<double>(mesh.positions.size()));
}

TEST(BuildHlod, EveryKindOfMeshBuildsValidatesAndComesBack) {
  const std::vector<std::pair<const char*, TriangleMesh>> meshes = {
      {"single_triangle", occlod::test::single_triangle()},
      {"grid", occlod::test::grid(60, 45)},
      {"fan", occlod::test::fan(2000)},
      {"moebius", occlod::test::moebius(500)},
      {"tetrahedron", occlod::test::tetrahedron()},
      {"noisy_sphere", noisy_sphere(5, 1)},
      {"torus", occlod::test::torus(60, 40)},
      {"double_sided_quad", occlod::test::double_sided_quad()},
      {"book", occlod::test::book(300)},
      {"many_tetrahedra", occlod::test::many_tetrahedra(500)},
      {"city", generate("city", {{"blocks", 4}, {"facade_cells", 8}})},
      {"spheres_behind_wall", generate("spheres-behind-wall", {{"spheres", 12}, {"level", 3}, {"wall_cells", 20}})}};
  for (const auto& [name, mesh] : meshes)
    for (std::size_t i = 0; i < 2 * all_kinds.size(); ++i) {
      const auto& [grouping, borders] = all_kinds[i / 2];
      HlodBuildOptions options = small_nodes(grouping, borders);
      options.within = i % 2 == 0 ? Within::splits : Within::geomorph;
      SCOPED_TRACE(std::string(name) + (grouping == Grouping::nested ? " nested" : " shifted") +
                   (borders == Borders::free ? " free" : " locked") + (i % 2 == 0 ? " with splits" : ""));
      const Hlod hlod = build_hlod(mesh, options);
      const std::vector<std::string> violations = validate(hlod);
      EXPECT_TRUE(violations.empty()) << violations[0];
      EXPECT_TRUE(restores(hlod, mesh));
      for (const Node& node : hlod.data().nodes) {
        if (node.level == 0) {
          EXPECT_LE(node.triangles, 64U);
        }
      }
    }
}

TEST(BuildHlod, EndsWithOneNodeOfAClosedSurface) {
  const Hlod hlod = build_hlod(noisy_sphere(6, 1), small_nodes());
  EXPECT_EQ(hlod.data().levels.back().node_count, 1U);
  EXPECT_EQ(hlod.data().roots.size(), 1U);
  // Each level has about a quarter of the triangles of the one below.
  std::vector<std::size_t> triangles(hlod.level_count(), 0);
  for (const Node& node : hlod.data().nodes) triangles[node.level] += node.triangles;
  for (std::size_t level = 1; level < triangles.size(); ++level) {
    EXPECT_LT(triangles[level], 0.4 * static_cast<double>(triangles[level - 1]));
    EXPECT_GT(triangles[level], 0.1 * static_cast<double>(triangles[level - 1]));
  }
}

TEST(BuildHlod, NestedNodesHaveOneParentAndShiftedOnesFew) {
  for (const Borders borders : {Borders::free, Borders::locked}) {
    const Hlod nested = build_hlod(noisy_sphere(5, 1), small_nodes(Grouping::nested, borders));
    for (const Node& node : nested.data().nodes) EXPECT_EQ(node.patches, 1U);
  }
  const Hlod shifted = build_hlod(noisy_sphere(6, 1), small_nodes());
  EXPECT_GT(shifted.data().patches.size(), shifted.node_count());
  for (const Node& node : shifted.data().nodes) EXPECT_LE(node.patches, 8U);
}

TEST(BuildHlod, TheSameBytesForAnyNumberOfThreads) {
  const TriangleMesh mesh = noisy_sphere(6, 3);
  for (const auto& [grouping, borders] : all_kinds) {
    HlodBuildOptions options = small_nodes(grouping, borders);
    const std::string one = test::bytes_of(build_hlod(mesh, options));
    for (const int threads : {2, 7}) {
      options.threads = threads;
      EXPECT_TRUE(test::bytes_of(build_hlod(mesh, options)) == one) << threads << " threads";
    }
  }
}

TEST(BuildHlod, KeepsAttributesWithTheirVertices) {
  TriangleMesh mesh = noisy_sphere(5, 1);
  for (const glm::vec3& p : mesh.positions) {
    mesh.normals.push_back(glm::normalize(p));
    mesh.colors.emplace_back(glm::u8vec4(glm::vec4(p * 50.0F + 120.0F, 255.0F)));
  }
  const Hlod hlod = build_hlod(mesh, small_nodes());
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    const NodeMesh node = hlod.mesh(n);
    ASSERT_EQ(node.normals.size(), node.positions.size());
    ASSERT_EQ(node.colors.size(), node.positions.size());
    for (std::size_t i = 0; i < node.positions.size(); ++i) {
      const auto of_input = std::ranges::find(mesh.normals, node.normals[i]);
      ASSERT_NE(of_input, mesh.normals.end());
      const auto v = static_cast<std::size_t>(of_input - mesh.normals.begin());
      EXPECT_EQ(node.colors[i], mesh.colors[v]);
      const float step = glm::distance(node.positions[i], mesh.positions[v]);
      EXPECT_LE(step, hlod.node(n).guaranteed_error);
    }
  }
}

// Moved vertices give levels of the same size that are nearer to the input.
TEST(BuildHlod, MovesVerticesToWhereTheyFit) {
  const TriangleMesh mesh = noisy_sphere(4, 1);
  HlodBuildOptions options = small_nodes();
  const Hlod moved = build_hlod(mesh, options);
  options.within = Within::splits;  // which keeps vertices where they are
  const Hlod kept = build_hlod(mesh, options);
  ASSERT_EQ(moved.level_count(), kept.level_count());
  for (std::size_t level = 1; level < moved.level_count(); ++level) {
    const double before = rms_distance(mesh, kept, level), after = rms_distance(mesh, moved, level);
    EXPECT_LT(after, 0.85 * before) << "level " << level;
  }
}

TEST(BuildHlod, MovesVerticesOnALatticeOnly) {
  HlodBuildOptions options = small_nodes();
  options.quantise_bits = 10;
  const Hlod hlod = build_hlod(noisy_sphere(6, 1), options);
  const double step = hlod.data().lattice_step;
  std::size_t moved = 0;
  std::set<std::array<float, 3>> of_input;
  for (NodeId n = static_cast<NodeId>(hlod.node_count()); n-- > 0;)
    for (const glm::vec3& p : hlod.mesh(n).positions) {
      for (int k = 0; k < 3; ++k) ASSERT_EQ(std::remainder(double{p[k]}, step), 0.0);
      if (hlod.node(n).level == 0)
        of_input.insert({p.x, p.y, p.z});
      else if (!of_input.contains({p.x, p.y, p.z}))
        ++moved;
    }
  EXPECT_GT(moved, 100U);
  EXPECT_TRUE(validate(hlod).empty());
}

TEST(BuildHlod, GeomorphTargetsLieInTheParentAndSharedVerticesStay) {
  const Hlod hlod = build_hlod(noisy_sphere(6, 1), small_nodes());
  std::size_t merged = 0, vertices = 0;
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    const NodeMesh mesh = hlod.mesh(n);
    const auto patches = hlod.patches(n);
    std::vector<int> users(mesh.positions.size(), 0);
    for (const Patch& patch : patches) {
      std::vector<bool> used(mesh.positions.size(), false);
      for (std::uint32_t i = patch.first_index; i < patch.first_index + patch.index_count; ++i)
        used[mesh.indices[i]] = true;
      for (std::size_t v = 0; v < used.size(); ++v) users[v] += used[v] ? 1 : 0;
    }
    for (std::size_t v = 0; v < users.size(); ++v) {
      if (users[v] > 1 || patches[0].parent == no_id) {
        EXPECT_EQ(mesh.merged_into[v], stays);
      }
      merged += mesh.merged_into[v] != stays ? 1U : 0U;
    }
    vertices += users.size();
  }
  // Three quarters of the vertices that are not shared go from level to level.
  EXPECT_GT(merged, vertices / 2);
}

void expect_refused(
    const TriangleMesh& mesh, const std::string& text,
    const std::function<void(HlodBuildOptions&)>& spoil = [](HlodBuildOptions&) {}) {
  HlodBuildOptions options;
  spoil(options);
  try {
    (void)build_hlod(mesh, options);
    ADD_FAILURE() << "builds, but should not: " << text;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
  }
}

TEST(BuildHlod, RefusesOptionsOutOfTheirRange) {
  const TriangleMesh mesh = occlod::test::tetrahedron();
  expect_refused(mesh, "option node_triangles", [](HlodBuildOptions& o) { o.node_triangles = 15; });
  expect_refused(mesh, "option node_triangles", [](HlodBuildOptions& o) { o.node_triangles = 4097; });
  expect_refused(mesh, "option threads", [](HlodBuildOptions& o) { o.threads = -1; });
  expect_refused(mesh, "option threads", [](HlodBuildOptions& o) { o.threads = 1025; });
  expect_refused(mesh, "need locked borders", [](HlodBuildOptions& o) { o.borders = Borders::free; });
}

TEST(BuildHlod, RefusesMeshesThatAreNotClean) {
  expect_refused({}, "has no triangles");
  TriangleMesh mesh = occlod::test::tetrahedron();
  mesh.positions[2].y = std::numeric_limits<float>::infinity();
  expect_refused(mesh, "vertex 2: is not finite");
  mesh = occlod::test::tetrahedron();
  mesh.triangles[1].z = 4;
  expect_refused(mesh, "triangle 1");
  mesh = occlod::test::tetrahedron();
  mesh.positions.push_back(mesh.positions[1]);
  expect_refused(mesh, "vertex 4: has the position of vertex 1");
}

TEST(BuildHlod, ReportsProgressAndCanBeCancelled) {
  const TriangleMesh mesh = noisy_sphere(7, 3);
  HlodBuildOptions options = small_nodes();
  std::vector<double> shares;
  options.progress = [&](double share) {
    shares.push_back(share);
    return true;
  };
  (void)build_hlod(mesh, options);
  ASSERT_GE(shares.size(), 2U);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GE(shares.front(), 0.0);
  EXPECT_EQ(shares.back(), 1.0);
  int calls = 0;
  expect_refused(mesh, "was cancelled", [&](HlodBuildOptions& o) { o.progress = [&](double) { return ++calls < 2; }; });
  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace occlod::hlod
