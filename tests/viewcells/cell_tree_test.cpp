#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>
#include <set>

#include "cells/cell_divider.h"
#include "cells/cell_geometry.h"
#include "cells/vlod_payload.h"
#include "occlod/base.h"
#include "occlod/vlod_file.h"

namespace occlod {
namespace {

using Set = std::vector<std::uint64_t>;

CellTreeOptions two_regions() {
  CellTreeOptions options;
  options.regions = {{{0, 0, 0}, {50, 30, 2}}, {{60, 0, 0}, {70, 10, 2}}};
  options.root_cell = 10.0;
  options.smallest_cell = 1.0;
  options.max_triangles = 100;
  return options;
}

// What is drawn is 10 for every unit of length along x, and 1000 more for a box that holds this point.
CellContent hand_made(const CellBox& box, const glm::dvec3& dear) {
  CellContent content;
  content.node.box = box;
  content.node.drawn_triangles = static_cast<std::uint32_t>(10.0 * (box.max.x - box.min.x));
  if (overlap(box, {dear, dear})) content.node.drawn_triangles += 1000;
  return content;
}

CellSubtree divided(const CellTreeOptions& options, const CellBox& root, const glm::dvec3& dear) {
  double shares = 0.0;
  const auto content_of = [&](const CellBox& box) { return hand_made(box, dear); };
  CellSubtree tree = divide_cell(options, content_of(root), content_of, [&](double share) { shares += share; });
  EXPECT_NEAR(shares, 1.0, 1e-12);
  finish(tree);
  return tree;
}

std::vector<CellBox> leaves_of(const CellSubtree& tree) {
  std::vector<CellBox> leaves;
  for (CellId n = 0; n < tree.nodes.size(); ++n)
    if (tree.nodes[n].end == n + 1) leaves.push_back(tree.nodes[n].box);
  return leaves;
}

TEST(CellDivision, PaperHalvesWhereAPartDrawsLessThanHalf) {
  CellTreeOptions options;
  options.max_triangles = 100;
  EXPECT_TRUE(is_worth_dividing(options, 200, std::vector<std::size_t>{99, 200, 200}));
  EXPECT_FALSE(is_worth_dividing(options, 200, std::vector<std::size_t>{100, 200, 200})) << "exactly half is not less";
  options.division = CellDivision::gain;
  EXPECT_FALSE(is_worth_dividing(options, 200, std::vector<std::size_t>{99, 200, 241}));
  EXPECT_TRUE(is_worth_dividing(options, 200, std::vector<std::size_t>{180, 180, 179}));
  EXPECT_FALSE(is_worth_dividing(options, 200, std::vector<std::size_t>{180, 180, 180})) << "nine tenths are not less";
}

TEST(CellDivision, StopsAtEveryLimit) {
  CellTreeOptions options = two_regions();
  const CellBox root{{0, 0, 0}, {8, 8, 1}};  // z is never long enough to be halved
  const glm::dvec3 dear{0.1, 0.1, 0.1};
  // 1080 drawn, so it is divided down to a cell of 1 round the dear point: 8 -> 4 -> 2 -> 1. The other parts draw 40.
  EXPECT_EQ(leaves_of(divided(options, root, dear)).size(), 3U * 3U + 1U);
  // Ten times at most: a cell of 1 is a cube, which is cut into eight.
  options.smallest_cell = 1e-9;
  EXPECT_EQ(leaves_of(divided(options, root, dear)).size(), 3U * 3U + 7U * 7U + 1U);
  options.smallest_cell = 1.5;
  EXPECT_EQ(leaves_of(divided(options, root, dear)).size(), 2U * 3U + 1U);
  options.max_triangles = 1080;
  EXPECT_EQ(leaves_of(divided(options, root, dear)).size(), 1U);
  // Without a dear point every part draws half of the 80: not less than half, so the division is taken back.
  options.max_triangles = 50;
  EXPECT_EQ(leaves_of(divided(options, root, {99, 0, 0})).size(), 1U);
  options.division = CellDivision::gain;
  EXPECT_EQ(leaves_of(divided(options, root, {99, 0, 0})).size(), 4U);
}

TEST(CellDivision, PartsFillTheBox) {
  const CellBox street{{0, 0, 0}, {16, 12, 2}}, corridor{{0, 0, 0}, {16, 2, 2}}, cube{{0, 0, 0}, {4, 4, 4}};
  EXPECT_EQ(parts_of(street, 1.0),
            (std::vector<CellBox>{
                {{0, 0, 0}, {8, 6, 2}}, {{8, 0, 0}, {16, 6, 2}}, {{0, 6, 0}, {8, 12, 2}}, {{8, 6, 0}, {16, 12, 2}}}));
  EXPECT_EQ(parts_of(corridor, 1.0), (std::vector<CellBox>{{{0, 0, 0}, {8, 2, 2}}, {{8, 0, 0}, {16, 2, 2}}}));
  EXPECT_EQ(parts_of(cube, 2.0).size(), 8U);
  EXPECT_EQ(parts_of(cube, 2.1), std::vector<CellBox>{cube}) << "halves would be too short";
  EXPECT_EQ(parts_of({{1, 1, 1}, {1, 1, 1}}, 0.5).size(), 1U) << "a point has no halves";
}

TEST(CellGrid, HilbertCurveGoesFromNeighbourToNeighbour) {
  constexpr std::uint32_t n = 8;
  std::vector<std::array<std::uint32_t, 3>> places(n * n * n);
  for (std::uint32_t i = 0; i < places.size(); ++i) places[i] = {i % n, i / n % n, i / n / n};
  std::ranges::sort(places, {}, hilbert_index);
  for (std::size_t i = 1; i < places.size(); ++i) {
    int steps = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      steps += std::abs(static_cast<int>(places[i][axis]) - static_cast<int>(places[i - 1][axis]));
    EXPECT_EQ(steps, 1);
  }
  for (std::uint32_t i = 0; i < places.size(); ++i) EXPECT_LT(hilbert_index(places[i]), n * n * n);
}

TEST(CellGrid, RootCellsFillTheirRegions) {
  const std::vector<RootCell> roots = root_cells(two_regions());
  ASSERT_EQ(roots.size(), 5U * 3U + 1U);
  double volume = 0.0;
  for (const RootCell& root : roots) {
    const glm::dvec3 size = root.box.max - root.box.min;
    volume += size.x * size.y * size.z;
    EXPECT_LE(std::max({size.x, size.y, size.z}), 10.0);
  }
  EXPECT_NEAR(volume, 50 * 30 * 2 + 10 * 10 * 2, 1e-9);
  EXPECT_EQ(roots.back().region, 1U);
  CellTreeOptions many = two_regions();
  many.root_cell = 1e-6;
  EXPECT_THROW((void)root_cells(many), Error);
}

// Random sets that resemble those of neighbours: one in four elements of a common pool is missing at random.
CellSets random_sets(std::mt19937& random, std::uint64_t pool) {
  CellSets sets;
  for (std::uint64_t i = 0; i < 300; ++i)
    if (random() % 4 != 0) sets.splits.push_back(pool + 3 * i);
  for (std::uint64_t owner = 0; owner < 200; ++owner) {
    for (std::uint64_t slot = 0; slot < 3; ++slot) {
      if (random() % 3 == 0)
        sets.hidden.push_back(owner << 32U | slot);
      else if (random() % 8 == 0)
        sets.drawn.push_back(owner << 32U | slot);
    }
  }
  return sets;
}

Set in_both(const Set& a, const Set& b) {
  Set both;
  std::ranges::set_intersection(a, b, std::back_inserter(both));
  return both;
}

TEST(CellSubtreeTest, HoldsTheSetsOfEveryLeaf) {
  std::mt19937 random(5);
  const std::vector<RootCell> roots = root_cells(two_regions());
  std::vector<CellSets> sets;
  for (const RootCell& root : roots) sets.push_back(random_sets(random, root.region * 100));
  CellSubtree tree = join_roots(roots, [&](std::size_t i) {
    CellNode node;
    node.box = roots[i].box;
    return leaf_of_tree(node, sets[i]);
  });
  finish(tree);
  const CellTree cells(tree.nodes, "cells");
  ASSERT_EQ(cells.leaf_count(), roots.size());

  std::vector<vlod::Additions> additions;
  for (CellId n = 0; n < tree.nodes.size(); ++n) {
    const CellNode& node = cells.node(n);
    const Set known = n == 0 ? Set{} : additions[node.parent].candidates;
    std::string problem;
    const auto bytes = std::span(tree.payloads).subspan(node.payload, node.payload_bytes);
    EXPECT_EQ(node.payload, n == 0 ? 0 : cells.node(n - 1).payload + cells.node(n - 1).payload_bytes);
    auto decoded = vlod::decode(bytes, {1000, 1000, node.splits, node.candidates, node.hidden_faces}, known, problem);
    ASSERT_TRUE(decoded) << problem;
    additions.push_back(std::move(*decoded));
  }
  // The i-th leaf is the i-th root cell.
  std::vector<CellId> leaves, path;
  for (CellId n = 0; n < tree.nodes.size(); ++n)
    if (cells.is_leaf(n)) leaves.push_back(n);
  const auto below = [&](CellId n, const auto& visit) {
    for (std::size_t i = 0; i < leaves.size(); ++i)
      if (leaves[i] >= n && leaves[i] < cells.node(n).end) visit(i);
  };
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    EXPECT_EQ(cells.node(leaves[i]).box, roots[i].box);
    cells.path_to(leaves[i], path);
    Set splits, hidden;
    for (const CellId n : path) {
      splits.insert(splits.end(), additions[n].splits.begin(), additions[n].splits.end());
      hidden.insert(hidden.end(), additions[n].hidden.begin(), additions[n].hidden.end());
      // So far it is what all leaves below have in common.
      std::ranges::sort(splits);
      Set common = sets[i].splits;
      below(n, [&](std::size_t leaf) { common = in_both(common, sets[leaf].splits); });
      EXPECT_EQ(splits, common) << "node " << n;
    }
    EXPECT_EQ(splits, sets[i].splits) << "no split is there twice";
    std::ranges::sort(hidden);
    EXPECT_EQ(std::ranges::adjacent_find(hidden), hidden.end()) << "no face is there twice";
    EXPECT_EQ(in_both(hidden, sets[i].hidden), sets[i].hidden) << "what is hidden is";
    EXPECT_TRUE(in_both(hidden, sets[i].drawn).empty()) << "what is drawn is not";
  }
}

TEST(CellTreeTest, FindsWhatASearchThroughAllLeavesFinds) {
  std::mt19937 random(7);
  const auto coordinate = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const std::vector<RootCell> roots = root_cells(two_regions());
  CellSubtree built = join_roots(roots, [&](std::size_t i) {
    CellSubtree tree = divided(two_regions(), roots[i].box, {12, 3, 1});
    tree.payloads.clear();
    for (CellNode& node : tree.nodes) node.payload = node.payload_bytes = 0;
    return tree;
  });
  finish(built);
  const CellTree tree(built.nodes, "cells");
  EXPECT_GT(tree.leaf_count(), roots.size());
  std::vector<CellId> leaves, found, expected, path, other;
  for (CellId n = 0; n < tree.nodes().size(); ++n)
    if (tree.is_leaf(n)) leaves.push_back(n);
  for (int n = 0; n < 2000; ++n) {
    glm::dvec3 eye{coordinate(-5, 75), coordinate(-5, 35), coordinate(-1, 3)};
    if (n % 3 == 0) eye = glm::round(eye / 5.0) * 5.0;  // on borders
    CellId holds = no_id, nearest = no_id;
    double best = std::numeric_limits<double>::infinity();
    for (const CellId leaf : leaves) {
      const double distance = smallest_distance(tree.node(leaf).box, {eye, eye});
      if (distance == 0.0 && holds == no_id) holds = leaf;
      if (distance < best) {
        best = distance;
        nearest = leaf;
      }
    }
    EXPECT_EQ(tree.leaf_of(eye), holds);
    EXPECT_EQ(tree.nearest_leaf(eye), nearest);
    const CellBox box{eye, eye + glm::dvec3(coordinate(0, 20), coordinate(0, 20), coordinate(0, 1))};
    expected.clear();
    for (const CellId leaf : leaves)
      if (overlap(tree.node(leaf).box, box)) expected.push_back(leaf);
    tree.leaves_in(box, found);
    EXPECT_EQ(found, expected);
  }
  for (const CellId a : leaves) {
    tree.path_to(a, path);
    EXPECT_EQ(path.front(), 0U);
    EXPECT_EQ(path.back(), a);
    tree.neighbours(a, found);
    for (const CellId b : leaves) {
      const CellBox &x = tree.node(a).box, &y = tree.node(b).box;
      const glm::dvec3 common = glm::min(x.max, y.max) - glm::max(x.min, y.min);
      int flat = 0, apart = 0;
      for (int axis = 0; axis < 3; ++axis) {
        flat += common[axis] == 0.0 ? 1 : 0;
        apart += common[axis] < 0.0 ? 1 : 0;
      }
      EXPECT_EQ(std::ranges::count(found, b), a != b && apart == 0 && flat == 1 ? 1 : 0) << a << " and " << b;
      tree.path_to(b, other);
      const auto split = std::ranges::mismatch(path, other);
      EXPECT_EQ(tree.common_ancestor(a, b), *(split.in1 - 1));
    }
  }
}

TEST(CellTreeTest, RefusesWhatIsNoTree) {
  const CellBox box{{0, 0, 0}, {2, 1, 1}}, left{{0, 0, 0}, {1, 1, 1}}, right{{1, 0, 0}, {2, 1, 1}};
  const auto node = [](const CellBox& b, CellId parent, CellId end, std::uint32_t level) {
    CellNode it;
    it.box = b;
    it.parent = parent;
    it.end = end;
    it.level = level;
    return it;
  };
  const std::vector<CellNode> good{node(box, no_id, 3, 0), node(left, 0, 2, 1), node(right, 0, 3, 1)};
  EXPECT_EQ(CellTree(good, "cells").leaf_count(), 2U);
  EXPECT_THROW(CellTree({}, "cells"), Error);
  const auto refused = [&](std::size_t n, const auto& change) {
    std::vector<CellNode> bad = good;
    change(bad[n]);
    EXPECT_THROW(CellTree(bad, "cells"), Error) << n;
  };
  refused(0, [](CellNode& it) { it.end = 2; });
  refused(0, [](CellNode& it) { it.end = 4; });
  refused(0, [](CellNode& it) { it.parent = 0; });
  refused(1, [](CellNode& it) { it.end = 4; });
  refused(1, [](CellNode& it) { it.end = 1; });
  refused(1, [](CellNode& it) { it.level = 2; });
  refused(2, [](CellNode& it) { it.parent = 1; });
  refused(2, [](CellNode& it) { it.parent = no_id; });
  refused(2, [](CellNode& it) { it.box.max.x = 2.5; });
  refused(2, [](CellNode& it) { it.box.max.x = 0.5; });
  refused(2, [](CellNode& it) { it.box.min.y = std::numeric_limits<double>::quiet_NaN(); });
  std::vector<CellNode> deep;
  for (CellId n = 0; n < 70; ++n) deep.push_back(node(box, n == 0 ? no_id : n - 1, 70, n));
  EXPECT_THROW(CellTree(deep, "cells"), Error);
}

}  // namespace
}  // namespace occlod
