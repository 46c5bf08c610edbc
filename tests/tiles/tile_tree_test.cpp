#include "hlod/tiles/tile_tree.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/hand_made_hlod.h"
#include "tile_support.h"

namespace occlod::tiles {
namespace {

using hlod::NodeId;
using occlod::test::Panel;
using test::nested_hlod;

TileTree complete_tree(const hlod::Hlod& hlod, TileError error, std::uint32_t tiles_per_file) {
  TileTree tree(hlod);
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    tree[n].content_box.take(glm::dvec3(hlod.node(n).box.min));
    tree[n].content_box.take(glm::dvec3(hlod.node(n).box.max));
  }
  tree.complete(error, tiles_per_file);
  return tree;
}

// A chain of three nodes whose errors are all the same, as those of planes are: tiles must still descend.
TEST(TileTree, ErrorsDescendWhereNodesHaveTheSame) {
  const std::vector<Panel> panel = {{{0, 0, 0}, {8, 8}, {3, 2, 1, 0}}};
  for (const float error : {0.0F, 0.5F}) {
    const hlod::Hlod hlod = occlod::test::hand_made_hlod(panel, std::vector<float>{error, error, error, 0.0F});
    const TileTree tree = complete_tree(hlod, TileError::quadric, 1000);
    EXPECT_EQ(tree[3].error, 0.0);
    EXPECT_GT(tree[2].error, 0.0);
    EXPECT_GT(static_cast<float>(tree[1].error), static_cast<float>(tree[2].error));
    EXPECT_GT(static_cast<float>(tree[0].error), static_cast<float>(tree[1].error));
    EXPECT_NEAR(tree[0].error, error, 1e-5);
    EXPECT_GT(tree.error(), tree[0].error);
  }
}

TEST(TileTree, ErrorsAreTheNodes) {
  const hlod::Hlod hlod = nested_hlod(occlod::test::noisy_sphere(5, 3));
  const TileTree guaranteed = complete_tree(hlod, TileError::guaranteed, 1000);
  const TileTree quadric = complete_tree(hlod, TileError::quadric, 1000);
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    EXPECT_NEAR(guaranteed[n].error, hlod.node(n).guaranteed_error, 1e-5 * hlod.node(n).guaranteed_error);
    EXPECT_NEAR(quadric[n].error, hlod.node(n).error, 1e-5 * hlod.node(n).error);
    for (const NodeId child : hlod.children(n))
      for (int k = 0; k < 3; ++k) {
        EXPECT_GE(guaranteed[child].box.min[k], guaranteed[n].box.min[k]);
        EXPECT_LE(guaranteed[child].box.max[k], guaranteed[n].box.max[k]);
        EXPECT_LT(guaranteed[child].error, guaranteed[n].error);
      }
  }
}

// Follows the files: every tile is in one, none has more than the limit but by the children of one tile.
TEST(TileTree, FilesHoldNoMoreThanTheLimit) {
  const hlod::Hlod hlod = nested_hlod(occlod::test::noisy_sphere(5, 3), 16);
  ASSERT_GT(hlod.node_count(), 500U);
  for (const std::uint32_t limit : {1U, 9U, 30U, 200U, 100'000U}) {
    const TileTree tree = complete_tree(hlod, TileError::guaranteed, limit);
    std::size_t files = 0, tiles = 0, max_children = 0;
    std::vector<NodeId> roots;  // of files
    std::vector<NodeId> here;
    for (const NodeId n : hlod.data().roots) (tree[n].is_external ? roots : here).push_back(n);
    std::size_t in_file = hlod.data().roots.size();
    max_children = in_file;
    while (true) {
      ++files;
      while (!here.empty()) {
        const NodeId n = here.back();
        here.pop_back();
        ++tiles;
        max_children = std::max(max_children, hlod.children(n).size());
        for (const NodeId child : hlod.children(n)) {
          ++in_file;
          (tree[child].is_external ? roots : here).push_back(child);
        }
      }
      EXPECT_LE(in_file, std::max<std::size_t>(limit, max_children + 1));
      if (roots.empty()) break;
      here = {roots.back()};
      roots.pop_back();
      in_file = 1;
    }
    EXPECT_EQ(tiles, hlod.node_count());
    EXPECT_EQ(files == 1, limit == 100'000U);
    // Files are filled: no more than four times as many as would do.
    if (limit >= 30) {
      EXPECT_LE(files, 4 * hlod.node_count() / limit + 1);
    }
  }
}

}  // namespace
}  // namespace occlod::tiles
