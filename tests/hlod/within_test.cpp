// Refinement within nodes: what a cut is, how large its error is, and that no gap opens beside it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "hlod/store/structure.h"
#include "hlod_bytes.h"
#include "occlod/build_hlod.h"
#include "splits/triangle_keys.h"
#include "support/meshes.h"
#include "support/open_edges.h"

namespace occlod::hlod {
namespace {

Hlod with_splits(const TriangleMesh& mesh, Borders borders = Borders::locked) {
  HlodBuildOptions options;
  options.node_triangles = 64;
  options.within = Within::splits;
  options.borders = borders;
  options.grouping = borders == Borders::free ? Grouping::nested : Grouping::shifted;
  return build_hlod(mesh, options);
}

const Hlod& sphere() {
  static const Hlod hlod = with_splits(occlod::test::noisy_sphere(6, 1));
  return hlod;
}

std::vector<NodeId> nodes_with_splits(const Hlod& hlod) {
  std::vector<NodeId> nodes;
  for (NodeId n = 0; n < hlod.node_count(); ++n)
    if (hlod.has_within(n)) nodes.push_back(n);
  return nodes;
}

std::vector<glm::vec3> positions_of(const Hlod& hlod, NodeId n) {
  const auto own = hlod.mesh(n).positions;
  std::vector<glm::vec3> all(own.begin(), own.end());
  const auto more = hlod.within(n).positions;
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

template <typename Indices>
void append_keys(const Indices& indices, std::span<const glm::vec3> positions, std::vector<TriangleKey>& keys) {
  for (std::size_t i = 0; i < indices.size(); i += 3)
    keys.push_back(key_of({indices[i], indices[i + 1], indices[i + 2]}, positions));
}

std::vector<TriangleKey> keys_of(const Hlod& hlod, NodeId n, const NodeCut& cut) {
  std::vector<TriangleKey> keys;
  append_keys(cut.indices, positions_of(hlod, n), keys);
  std::sort(keys.begin(), keys.end());
  return keys;
}

// Of the patches that n replaces. On a sphere without folds none of them cancel.
std::vector<TriangleKey> keys_of_input(const Hlod& hlod, NodeId n) {
  std::vector<TriangleKey> keys;
  for (const NodeId child : hlod.children(n))
    for (const Patch& patch : hlod.patches(child)) {
      if (patch.parent != n) continue;
      const NodeMesh mesh = hlod.mesh(child);
      append_keys(mesh.indices.subspan(patch.first_index, patch.index_count), mesh.positions, keys);
    }
  std::sort(keys.begin(), keys.end());
  return keys;
}

TEST(Within, AllSplitsGiveTheInputOfTheNodeAndNoneItsMesh) {
  const std::vector<NodeId> nodes = nodes_with_splits(sphere());
  EXPECT_GT(nodes.size(), sphere().data().levels[0].first_node * 9 / 10)
      << "but for a few whose vertices are all locked";
  for (const NodeId n : nodes) {
    EXPECT_GT(sphere().node(n).level, 0);
    const std::uint32_t splits = sphere().data().within[n].splits;
    EXPECT_EQ(keys_of(sphere(), n, cut_with_splits(sphere(), n, splits)), keys_of_input(sphere(), n));
    std::vector<TriangleKey> own;
    append_keys(sphere().mesh(n).indices, sphere().mesh(n).positions, own);
    std::sort(own.begin(), own.end());
    EXPECT_EQ(keys_of(sphere(), n, cut_with_splits(sphere(), n, 0)), own);
  }
}

TEST(Within, TheErrorIsKeptByTheFewestSplits) {
  for (const NodeId n : nodes_with_splits(sphere())) {
    const Node& node = sphere().node(n);
    const auto least = static_cast<double>(node.child_error), most = static_cast<double>(node.error);
    EXPECT_EQ(splits_to_error(sphere(), n, most), 0U);
    EXPECT_EQ(splits_to_error(sphere(), n, std::numeric_limits<double>::infinity()), 0U);
    EXPECT_EQ(error_of_splits(sphere(), n, 0), most);
    std::uint32_t last = 0;
    for (double share = 1.0; share >= -0.1; share -= 0.125) {
      const double wanted = least + share * (most - least);
      const std::uint32_t splits = splits_to_error(sphere(), n, wanted);
      EXPECT_GE(splits, last) << "a smaller error needs no fewer";
      last = splits;
      if (wanted < least) continue;
      EXPECT_LE(error_of_splits(sphere(), n, splits), wanted);
      if (splits > 0) {
        EXPECT_GT(error_of_splits(sphere(), n, splits - 1), wanted) << "one split fewer would do";
      }
    }
    EXPECT_EQ(error_of_splits(sphere(), n, sphere().data().within[n].splits), least);
  }
}

TEST(Within, HalfOfTheErrorTakesSomeOfTheTriangles) {
  std::size_t between = 0, nodes = 0;
  for (const NodeId n : nodes_with_splits(sphere())) {
    const Node& node = sphere().node(n);
    const NodeCut cut =
        within_cut(sphere(), n, 0.5 * (static_cast<double>(node.child_error) + static_cast<double>(node.error)));
    const std::size_t input = sphere().within(n).indices.size();
    EXPECT_GE(cut.indices.size(), 3 * std::size_t{node.triangles});
    EXPECT_LE(cut.indices.size(), input);
    between += cut.indices.size() > 3 * std::size_t{node.triangles} && cut.indices.size() < input ? 1U : 0U;
    ++nodes;
  }
  EXPECT_GT(between, nodes * 9 / 10);
}

TEST(Within, NodesWithoutSplitsAreTheirOwnCut) {
  HlodBuildOptions options;
  options.node_triangles = 64;
  const Hlod plain = build_hlod(occlod::test::noisy_sphere(4, 1), options);
  for (NodeId n = 0; n < plain.node_count(); ++n) {
    EXPECT_FALSE(plain.has_within(n));
    EXPECT_EQ(splits_to_error(plain, n, 0.0), 0U);
    const NodeCut cut = within_cut(plain, n, 0.0);
    EXPECT_EQ(cut.splits, 0U);
    EXPECT_TRUE(std::ranges::equal(cut.indices, plain.mesh(n).indices));
  }
}

TEST(Within, KeepsVerticesWhereTheInputHasThem) {
  const TriangleMesh mesh = occlod::test::noisy_sphere(5, 3);
  HlodBuildOptions options;
  options.node_triangles = 64;
  options.within = Within::splits;
  const Hlod splits = build_hlod(mesh, options);
  std::set<std::array<float, 3>> of_input;
  for (const glm::vec3& p : mesh.positions) of_input.insert({p.x, p.y, p.z});
  for (NodeId n = 0; n < splits.node_count(); ++n)
    for (const glm::vec3& p : splits.mesh(n).positions) EXPECT_TRUE(of_input.contains({p.x, p.y, p.z}));
}

TEST(Within, TheSameBytesForAnyNumberOfThreads) {
  HlodBuildOptions options;
  options.node_triangles = 64;
  options.within = Within::splits;
  options.threads = 1;
  const TriangleMesh mesh = occlod::test::noisy_sphere(6, 3);
  const std::string one = test::bytes_of(build_hlod(mesh, options));
  for (const int threads : {2, 7}) {
    options.threads = threads;
    EXPECT_TRUE(test::bytes_of(build_hlod(mesh, options)) == one) << threads << " threads";
  }
}

TEST(Within, AttributesComeBackWithTheirVertices) {
  TriangleMesh mesh = occlod::test::noisy_sphere(5, 1);
  for (const glm::vec3& p : mesh.positions) {
    mesh.normals.push_back(p / 2.0F);
    mesh.colors.emplace_back(glm::u8vec4(glm::vec4(p * 50.0F + 120.0F, 255.0F)));
  }
  const Hlod hlod = with_splits(mesh);
  for (const NodeId n : nodes_with_splits(hlod)) {
    const NodeSplits within = hlod.within(n);
    ASSERT_EQ(within.normals.size(), within.positions.size());
    ASSERT_EQ(within.colors.size(), within.positions.size());
    for (std::size_t i = 0; i < within.positions.size(); ++i) {
      EXPECT_EQ(within.normals[i], within.positions[i] / 2.0F);
      EXPECT_EQ(within.colors[i], glm::u8vec4(glm::vec4(within.positions[i] * 50.0F + 120.0F, 255.0F)));
    }
  }
}

std::size_t open_edges(const Hlod& hlod, const Refined& refined, const Cuts& cuts) {
  occlod::test::OpenEdges edges;
  for_each_drawn(hlod, refined, [&](NodeId n, const Patch& patch, std::size_t) {
    const NodeMesh mesh = hlod.mesh(n);
    if (cuts[n] == 0) edges.add(mesh.indices.subspan(patch.first_index, patch.index_count), mesh.positions);
  });
  for (NodeId n = 0; n < cuts.size(); ++n)
    if (cuts[n] > 0) edges.add(cut_with_splits(hlod, n, cuts[n]).indices, positions_of(hlod, n));
  return edges.count();
}

TEST(WithinFronts, AClosedSurfaceStaysClosed) {
  const Hlod hlod = with_splits(occlod::test::noisy_sphere(5, 2));
  std::mt19937_64 random(1);
  std::ptrdiff_t cut_nodes = 0;
  for (int i = 0; i < 200; ++i) {
    const Refined refined = random_front(hlod, random);
    const Cuts cuts = random_cuts_of(hlod, refined, random);
    cut_nodes += std::ranges::count_if(cuts, [](std::uint32_t splits) { return splits > 0; });
    EXPECT_EQ(open_edges(hlod, refined, cuts), 0U);
  }
  EXPECT_GT(cut_nodes, 200);
}

bool is_drawn(const Refined& refined, const Patch& patch) {
  return patch.parent == no_id || refined[patch.parent] != 0;
}

TEST(WithinFronts, CutsBesideParentsThatAreNotRefinedGape) {
  // Such a cut cannot be drawn: it has no patches, and the parent that is not refined covers part of the same surface.
  const Hlod hlod = with_splits(occlod::test::noisy_sphere(5, 2));
  std::mt19937_64 random(1);
  int tried = 0;
  for (int i = 0; i < 200; ++i) {
    const Refined refined = random_front(hlod, random);
    for (const NodeId n : nodes_with_splits(hlod)) {
      const auto patches = hlod.patches(n);
      const auto drawn = std::ranges::count_if(patches, [&](const Patch& patch) { return is_drawn(refined, patch); });
      if (refined[n] != 0 || drawn == 0 || drawn == std::ssize(patches)) continue;
      Cuts cuts(hlod.node_count(), 0);
      cuts[n] = hlod.data().within[n].splits;
      EXPECT_GT(open_edges(hlod, refined, cuts), 0U);
      ++tried;
      break;
    }
  }
  EXPECT_GT(tried, 50);
}

TEST(WithinFronts, WhatAnErrorByDistanceAsksForIsLegal) {
  // Nodes are refined where even their finest cut has too large an error. That error shrinks with every level, so
  // whatever needs a cut has all parents refined, and the others are good enough as they are.
  const Hlod hlod = with_splits(occlod::test::noisy_sphere(5, 2));
  std::mt19937_64 random(1);
  const auto number = [&] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  std::ptrdiff_t cut_nodes = 0;
  for (int i = 0; i < 50; ++i) {
    const glm::dvec3 eye(2.0 * number(), 2.0 * number(), 2.0 * number());
    const double tolerance = std::exp2(-6.0 + 4.0 * number());  // error per distance
    const auto distance = [&](const Box& box) {
      return glm::distance(eye, glm::clamp(eye, glm::dvec3(box.min), glm::dvec3(box.max)));
    };
    Refined refined(hlod.node_count(), 0);
    Cuts cuts(hlod.node_count(), 0);
    for (NodeId n = 0; n < hlod.node_count(); ++n) {
      const Node& node = hlod.node(n);
      const bool all =
          std::ranges::all_of(hlod.patches(n), [&](const Patch& patch) { return is_drawn(refined, patch); });
      refined[n] = static_cast<double>(node.child_error) > tolerance * distance(node.lod_box) ? 1 : 0;
      if (refined[n] != 0) {
        EXPECT_TRUE(all);
      } else if (static_cast<double>(node.error) > tolerance * distance(node.box)) {
        EXPECT_TRUE(all);
        cuts[n] = splits_to_error(hlod, n, tolerance * distance(node.box));
        cut_nodes += cuts[n] > 0 ? 1 : 0;
      }
    }
    EXPECT_EQ(open_edges(hlod, refined, cuts), 0U);
  }
  EXPECT_GT(cut_nodes, 500);
}

TEST(WithinFronts, CutsOfFreeNodesGape) {
  std::mt19937_64 random(1);
  const Hlod hlod = with_splits(occlod::test::noisy_sphere(5, 2), Borders::free);
  const Refined refined = random_front(hlod, random);
  EXPECT_GT(open_edges(hlod, refined, random_cuts_of(hlod, refined, random)), 0U);
}

TEST(ErrorStep, RoundsDownToQuarterPowersOfTwo) {
  EXPECT_EQ(error_step(0.0), 0.0);
  EXPECT_EQ(error_step(1.0), 1.0);
  EXPECT_EQ(error_step(1.1), 1.0);
  EXPECT_EQ(error_step(1.2), std::exp2(0.25));
  EXPECT_EQ(error_step(1.5), std::exp2(0.5));
  EXPECT_EQ(error_step(1.99), std::exp2(0.75));
  EXPECT_EQ(error_step(std::nextafter(2.0, 0.0)), std::exp2(0.75));
  EXPECT_EQ(error_step(0.25), 0.25);
  EXPECT_EQ(error_step(1e-310), std::ldexp(error_step(std::ldexp(1e-310, 100)), -100)) << "subnormal";
  EXPECT_EQ(error_step(std::numeric_limits<double>::infinity()), std::exp2(0.75) * 0x1p1023);
  for (double x = 1e-6; x < 1e6; x *= 1.01) {
    EXPECT_LE(error_step(x), x);
    EXPECT_GT(error_step(x) * 1.1893, x);
    EXPECT_EQ(error_step(error_step(x)), error_step(x));
  }
}

TEST(CutCache, GivesTheCutOfTheStepAndKeepsIt) {
  CutCache cache;
  const NodeId n = 0;
  const double most = sphere().node(n).error, least = sphere().node(n).child_error;
  const double step = error_step(0.5 * (most + least));
  cache.begin_frame();
  const NodeCut& cut = cache.get(sphere(), n, step * 1.1);
  EXPECT_EQ(cut.splits, splits_to_error(sphere(), n, step));
  EXPECT_EQ(cut.indices, cut_with_splits(sphere(), n, cut.splits).indices);
  EXPECT_GT(cache.bytes(), cut.indices.size() * 2);
  const std::size_t bytes = cache.bytes();
  EXPECT_EQ(&cache.get(sphere(), n, step), &cut) << "the same step";
  EXPECT_EQ(cache.bytes(), bytes);
  cache.begin_frame();
  EXPECT_EQ(&cache.get(sphere(), n, step * 1.05), &cut) << "in the next frame too";
  EXPECT_EQ(cache.get(sphere(), n, most).splits, 0U);
  EXPECT_TRUE(cache.get(sphere(), n, most).indices.empty());
  EXPECT_EQ(cache.get(sphere(), static_cast<NodeId>(sphere().node_count() - 1), 0.0).splits, 0U) << "of level 0";
}

TEST(CutCache, DropsWhatWasNotUsedForLongest) {
  const auto cut_of = [](CutCache& cache, NodeId n) -> const NodeCut& {
    return cache.get(sphere(), n, static_cast<double>(sphere().node(n).child_error));
  };
  CutCache cache(1);
  cache.begin_frame();
  const NodeCut& first = cut_of(cache, 0);
  const std::vector<std::uint16_t> indices = first.indices;
  (void)cut_of(cache, 1);
  EXPECT_EQ(first.indices, indices) << "all live as long as the frame";
  cache.begin_frame();
  EXPECT_EQ(cache.bytes(), 0U) << "one cut has more than a byte";

  CutCache two(cache.bytes() + 1);
  (void)cut_of(two, 1);
  const std::size_t bytes_of_one = two.bytes();
  CutCache roomy(bytes_of_one);
  roomy.begin_frame();
  (void)cut_of(roomy, 2);
  (void)cut_of(roomy, 1);
  roomy.begin_frame();
  EXPECT_EQ(roomy.bytes(), bytes_of_one) << "node 2 was used before node 1";
}

}  // namespace
}  // namespace occlod::hlod
