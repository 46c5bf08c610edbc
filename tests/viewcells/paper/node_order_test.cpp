// Orders of ids by the nodes that add them.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "cells/packed_numbers.h"
#include "papers/first_node.h"
#include "papers/hamming_tour.h"

namespace occlod::paper {
namespace {

// A binary tree over 2^levels cells, from the sets of the cells: what each node adds, in depth-first order.
class Tree {
 public:
  explicit Tree(const std::vector<Ids>& cells) : cells_(cells) { add(0, cells.size(), {}); }
  [[nodiscard]] const std::vector<Ids>& added() const { return added_; }

 private:
  Ids common(std::size_t first, std::size_t end) const {
    Ids result = cells_[first];
    for (std::size_t c = first + 1; c < end; ++c) {
      Ids both;
      std::set_intersection(result.begin(), result.end(), cells_[c].begin(), cells_[c].end(), std::back_inserter(both));
      result = std::move(both);
    }
    return result;
  }
  void add(std::size_t first, std::size_t end, const Ids& above) {
    const Ids all = common(first, end);
    added_.push_back(delta(above, all).added);
    if (end - first == 1) return;
    const std::size_t middle = (first + end) / 2;
    add(first, middle, all);
    add(middle, end, all);
  }
  const std::vector<Ids>& cells_;
  std::vector<Ids> added_;
};

constexpr std::uint32_t count = 60;

// An id depends on at most one other, of a smaller number, which is in all its cells and mostly in more.
struct Sets {
  std::vector<std::vector<std::uint32_t>> cells_of = std::vector<std::vector<std::uint32_t>>(count);
  std::vector<std::uint32_t> parents = std::vector<std::uint32_t>(count, count);
  std::vector<Ids> cells = std::vector<Ids>(8);
};
Sets random_sets(std::mt19937_64& random) {
  Sets sets;
  for (std::uint32_t id = 0; id < count; ++id) {
    if (id >= 6) sets.parents[id] = static_cast<std::uint32_t>(random() % id);
    for (std::uint32_t cell = 0; cell < 8; ++cell) {
      const std::uint32_t parent = sets.parents[id];
      const bool may =
          parent == count || std::binary_search(sets.cells_of[parent].begin(), sets.cells_of[parent].end(), cell);
      if (may && random() % 5 > 0) {
        sets.cells_of[id].push_back(cell);
        sets.cells[cell].push_back(id);
      }
    }
  }
  return sets;
}

TEST(NodeOrder, KeepsDependenciesAndJoinsWhatIsInTheSameCells) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 300; ++i) {
    const Sets sets = random_sets(random);
    const Tree tree(sets.cells);
    const std::vector<std::uint32_t> places = places_by_nodes(tree.added(), count);
    std::vector<std::uint32_t> order(count);
    for (std::uint32_t id = 0; id < count; ++id) order[places[id]] = id;
    for (std::uint32_t id = 0; id < count; ++id)
      EXPECT_TRUE(sets.parents[id] == count || places[sets.parents[id]] < places[id]);
    for (std::uint32_t a = 0; a < count; ++a)  // whoever lies between two of the same cells is of those cells
      for (std::uint32_t b = 0; b < count; ++b)
        for (std::uint32_t p = places[a]; sets.cells_of[a] == sets.cells_of[b] && p < places[b]; ++p)
          EXPECT_EQ(sets.cells_of[order[p]], sets.cells_of[a]);
    const std::vector<std::uint32_t> first = places_by_first_node(tree.added(), count);
    for (std::uint32_t id = 0; id < count; ++id)
      EXPECT_TRUE(sets.parents[id] == count || first[sets.parents[id]] < first[id]);
    // The matrix of ids and cells: fewer runs than as numbered and than by the first node alone.
    const BitColumns columns(sets.cells_of);
    Order numbered(count), by_first(count);
    for (std::uint32_t id = 0; id < count; ++id) {
      numbered[id] = id;
      by_first[first[id]] = id;
    }
    EXPECT_LE(count_runs(columns, order), count_runs(columns, numbered));
    EXPECT_LE(count_runs(columns, order), count_runs(columns, by_first));
  }
}

// 0 is in all cells, 2 and 4 in the second, 3 in both halves but for the first cell, 1 in none.
TEST(NodeOrder, OfAHandMadeTree) {
  const std::vector<Ids> cells = {{0}, {0, 2, 3, 4}, {0, 3}, {0, 3}};
  const Tree tree(cells);
  EXPECT_EQ(tree.added(), (std::vector<Ids>{{0}, {}, {}, {2, 3, 4}, {3}, {}, {}}));
  // 3 is added by nodes 3 and 4; 2 and 4 by 3 alone.
  EXPECT_EQ(places_by_nodes(tree.added(), 5), (std::vector<std::uint32_t>{0, 4, 2, 1, 3}));
  EXPECT_EQ(places_by_first_node(tree.added(), 5), (std::vector<std::uint32_t>{0, 4, 1, 2, 3}));
}

}  // namespace
}  // namespace occlod::paper
