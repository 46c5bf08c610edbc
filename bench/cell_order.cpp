// bench_cell_order: lists of splits of the cells of a grid. Their order by the tour of vLOD (2003), Table 1, and by our
// sort; their codes; and what is read when the eye goes from a cell to the next.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "occlod/hierarchy/build.h"
#include "occlod/mesh/generate.h"
#include "occlod/viewcells/cell_builder.h"
#include "oracle/cell_oracle.h"
#include "support/cpu_clock.h"
#include "viewcells/cell_subtree.h"
#include "viewcells/paper/adaptive_huffman.h"
#include "viewcells/paper/delimiter_code.h"
#include "viewcells/paper/hamming_tour.h"
#include "viewcells/paper/id_lists.h"
#include "viewcells/set_code.h"

namespace occlod::bench {
namespace {

using paper::Ids;
using paper::Order;

constexpr double street = 14.0, pitch = 60.0;  // of generate_city()
constexpr double edge = 3.5;                   // of a cell: four side by side in a street
constexpr std::uint32_t most_neighbours = 20;
constexpr std::size_t most_moves = 500'000;

double seconds() { return 1e-3 * thread_cpu_ms(); }

// --- cells

// The cells of a square grid whose middles are in a street.
struct Grid {
  int side = 0;                           // a power of two
  std::vector<std::optional<Ids>> cells;  // row by row: the splits of those that are there
  std::uint32_t split_count = 0;

  [[nodiscard]] const std::optional<Ids>& at(int x, int y) const {
    return cells[static_cast<std::size_t>(y * side + x)];
  }
};

bool is_in_street(double t) {
  const double from_middle = std::abs(t - pitch * std::round(t / pitch));
  return from_middle < street / 2.0;
}

Grid build_grid(int side) {
  const Hierarchy city = build_hierarchy(generate_city({.blocks = 8, .facade_cells = 8}));
  const RefineObject objects[] = {{.hierarchy = &city}};
  const CellOccluders occluders(objects, 0.25);
  CellBuilder builder(objects, &occluders, {.eyes = test::cube_eyes(1024, 0.1)});
  Grid grid{side, {}, static_cast<std::uint32_t>(city.split_count())};
  const double corner = 3.0 * pitch - street / 2.0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const glm::dvec3 low(corner + x * edge, corner + y * edge, 1.0), size(edge, edge, 1.5);
      grid.cells.emplace_back();
      if (!is_in_street(low.x + edge / 2.0) && !is_in_street(low.y + edge / 2.0)) continue;
      grid.cells.back() = builder.build({low, low + size}).objects[0].applied;
    }
  return grid;
}

// --- the tree of additions

struct Node {
  Ids common;  // that all cells below have
  Ids added;   // of these, those that not all cells below the parent have
  std::size_t parent = 0;
};

// In depth-first order, a quarter of the square after the other.
class Tree {
 public:
  explicit Tree(const Grid& grid) : grid_(grid), leaf_(grid.cells.size(), 0) {
    add(0, 0, grid.side, 0);
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      nodes_[n].added =
          n == 0 ? nodes_[n].common : paper::delta(nodes_[nodes_[n].parent].common, nodes_[n].common).added;
  }
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  [[nodiscard]] std::size_t leaf(int x, int y) const { return leaf_[static_cast<std::size_t>(y * grid_.side + x)]; }

 private:
  // Whether there was any cell.
  bool add(int x, int y, int side, std::size_t parent) {
    const std::size_t n = nodes_.size();
    nodes_.push_back({{}, {}, parent});
    if (side == 1) {
      if (!grid_.at(x, y)) {
        nodes_.pop_back();
        return false;
      }
      nodes_[n].common = *grid_.at(x, y);
      leaf_[static_cast<std::size_t>(y * grid_.side + x)] = n;
      return true;
    }
    bool is_first = true;
    for (int quarter = 0; quarter < 4; ++quarter) {
      const std::size_t child = nodes_.size();
      if (!add(x + quarter % 2 * side / 2, y + quarter / 2 * side / 2, side / 2, n)) continue;
      Ids both;
      std::set_intersection(nodes_[n].common.begin(), nodes_[n].common.end(), nodes_[child].common.begin(),
                            nodes_[child].common.end(), std::back_inserter(both));
      nodes_[n].common = is_first ? nodes_[child].common : std::move(both);
      is_first = false;
    }
    if (is_first) nodes_.pop_back();
    return !is_first;
  }

  const Grid& grid_;
  std::vector<Node> nodes_;
  std::vector<std::size_t> leaf_;
};

// The tree as it is in files, of splits alone.
CellSubtree packed_tree(const Grid& grid, int x, int y, int side) {
  if (side == 1) {
    if (!grid.at(x, y)) return {};
    CellSets sets;
    sets.splits.assign(grid.at(x, y)->begin(), grid.at(x, y)->end());
    CellNode node;
    node.box = {{x, y, 0}, {x + 1, y + 1, 1}};
    return leaf_of_tree(node, std::move(sets));
  }
  std::vector<CellSubtree> parts;
  for (int quarter = 0; quarter < 4; ++quarter) {
    CellSubtree part = packed_tree(grid, x + quarter % 2 * side / 2, y + quarter / 2 * side / 2, side / 2);
    if (!part.nodes.empty()) parts.push_back(std::move(part));
  }
  if (parts.size() < 2) return parts.empty() ? CellSubtree{} : std::move(parts[0]);
  return join(std::move(parts));
}

// --- transitions

struct Transition {
  std::size_t from = 0, to = 0;  // leaves of the tree
  glm::ivec2 from_cell{0}, to_cell{0};
  paper::Delta delta;
};

std::vector<Transition> transitions_of(const Grid& grid, const Tree& tree) {
  std::vector<Transition> transitions;
  for (int y = 0; y < grid.side; ++y)
    for (int x = 0; x < grid.side; ++x)
      for (const glm::ivec2 step : {glm::ivec2(1, 0), glm::ivec2(0, 1)}) {
        const glm::ivec2 to = glm::ivec2(x, y) + step;
        if (to.x == grid.side || to.y == grid.side || !grid.at(x, y) || !grid.at(to.x, to.y)) continue;
        transitions.push_back(
            {tree.leaf(x, y), tree.leaf(to.x, to.y), {x, y}, to, paper::delta(*grid.at(x, y), *grid.at(to.x, to.y))});
      }
  return transitions;
}

// All lists of a crossing, in either direction.
std::vector<Ids> lists_of(const std::vector<Transition>& transitions) {
  std::vector<Ids> lists;
  for (const Transition& t : transitions)
    for (const Ids* list : {&t.delta.added, &t.delta.removed})
      if (!list->empty()) lists.push_back(*list);
  return lists;
}

// --- order

// The nodes that add each id, in depth-first order.
struct Adders {
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> nodes;

  Adders(const std::vector<Node>& tree, std::uint32_t count) : first(count + std::size_t{1}, 0) {
    for (const Node& node : tree)
      for (const std::uint32_t id : node.added) ++first[id + std::size_t{1}];
    std::partial_sum(first.begin(), first.end(), first.begin());
    nodes.resize(first.back());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t n = 0; n < tree.size(); ++n)
      for (const std::uint32_t id : tree[n].added) nodes[next[id]++] = static_cast<std::uint32_t>(n);
  }
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t id) const {
    return {nodes.data() + first[id], first[id + 1] - first[id]};
  }
  // Of the first two nodes; what ends comes last.
  [[nodiscard]] std::uint64_t key(std::uint32_t id) const {
    const auto list = of(id);
    return std::uint64_t{list.empty() ? no_id : list[0]} << 32U | (list.size() < 2 ? no_id : list[1]);
  }
  [[nodiscard]] bool less(std::uint32_t a, std::uint32_t b) const {
    const auto left = of(a), right = of(b);
    const auto [l, r] = std::mismatch(left.begin(), left.end(), right.begin(), right.end());
    if (l != left.end() && r != right.end()) return *l < *r;
    if (l == left.end() && r == right.end()) return a < b;
    return r == right.end();
  }
};

// Where each id comes: by the list of nodes that add it, one that goes on before one that ends, then by number. A split
// that another depends on is in every cell that the other is in. So where their lists differ first, its node is farther
// up, or earlier, or the other's list has ended: it comes first, as files need it. Splits of the same cells are one
// run.
std::vector<std::uint32_t> sorted_places(const std::vector<Node>& tree, std::uint32_t count, bool by_first_alone) {
  const Adders adders(tree, count);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(count);
  for (std::uint32_t id = 0; id < count; ++id) order[id] = {adders.key(id), id};
  if (by_first_alone)
    for (auto& [key, id] : order) key >>= 32U;
  std::sort(order.begin(), order.end(), [&](const auto& a, const auto& b) {
    if (a.first != b.first) return a.first < b.first;
    return by_first_alone ? a.second < b.second : adders.less(a.second, b.second);
  });
  std::vector<std::uint32_t> places(count);
  for (std::uint32_t i = 0; i < count; ++i) places[order[i].second] = i;
  return places;
}

std::vector<Ids> renumbered(std::vector<Ids> lists, const std::vector<std::uint32_t>& places) {
  for (Ids& list : lists) {
    for (std::uint32_t& id : list) id = places[id];
    std::sort(list.begin(), list.end());
  }
  return lists;
}

std::size_t count_runs(const std::vector<Ids>& lists) {
  std::size_t runs = 0;
  for (const Ids& list : lists) runs += paper::runs_of(list).size() / 2;
  return runs;
}

// Only some ids, numbered from 0 in their order.
struct Part {
  std::vector<Ids> lists;
  std::vector<Node> nodes;
};

Part part_of(const std::vector<Ids>& lists, const std::vector<Node>& nodes, const Ids& kept) {
  const auto keep = [&](const Ids& ids) {
    Ids result;
    for (const std::uint32_t id : ids) {
      const auto place = std::lower_bound(kept.begin(), kept.end(), id);
      if (place != kept.end() && *place == id) result.push_back(static_cast<std::uint32_t>(place - kept.begin()));
    }
    return result;
  };
  Part part;
  for (const Ids& list : lists) part.lists.push_back(keep(list));
  for (const Node& node : nodes) part.nodes.push_back({{}, keep(node.added), node.parent});
  return part;
}

struct TableRow {
  double tour_s = 0.0, sort_s = 0.0, tour_gain = 0.0, sort_gain = 0.0;
};

TableRow print_table_row(const std::vector<Ids>& lists, const std::vector<Node>& nodes, const Ids& kept) {
  const Part part = part_of(lists, nodes, kept);
  std::vector<std::vector<std::uint32_t>> rows(kept.size());
  for (std::uint32_t row = 0; row < part.lists.size(); ++row)
    for (const std::uint32_t column : part.lists[row]) rows[column].push_back(row);
  const paper::BitColumns columns(rows);
  const auto count = static_cast<std::uint32_t>(kept.size());
  const std::size_t before = count_runs(part.lists);
  const auto gain = [&](std::size_t runs) { return static_cast<double>(before) / static_cast<double>(runs); };

  const double start = seconds();
  const paper::Neighbours near = paper::nearest_columns(columns, most_neighbours);
  const double after_near = seconds();
  Order order = paper::greedy_tour(columns, near);
  const double after_seed = seconds();
  const std::size_t seed_runs = paper::count_runs(columns, order);
  const double improving = seconds();
  const paper::Improvement improved = paper::improve_tour(columns, near, order, most_moves);
  const double end = seconds();

  // By one common sample instead.
  const auto sample_size = static_cast<std::uint32_t>(20.0 * std::log(static_cast<double>(count)));
  const double before_sample = seconds();
  const paper::Neighbours sampled =
      paper::nearest_of_sample(columns, most_neighbours, paper::sample_columns(columns, sample_size, 1));
  const double after_sample = seconds();
  Order sampled_order = paper::greedy_tour(columns, sampled);
  const paper::Improvement sampled_tour = paper::improve_tour(columns, sampled, sampled_order, most_moves);

  const double before_sort = seconds();
  const std::vector<std::uint32_t> places = sorted_places(part.nodes, count, false);
  const double sort_s = seconds() - before_sort;
  const std::size_t sorted_runs = count_runs(renumbered(part.lists, places));
  const std::size_t first_runs = count_runs(renumbered(part.lists, sorted_places(part.nodes, count, true)));

  const TableRow row{after_seed - start + end - improving, sort_s, gain(improved.runs), gain(sorted_runs)};
  fmt::print("{},{},{},{:.3f},{:.3f},{:.2f},{:.2f},{},{:.3g},{:.3f},{:.4f},{:.2f},{:.6f},{:.2f},{:.2f}\n", count,
             part.lists.size(), before, after_near - start, after_seed - after_near, gain(seed_runs), row.tour_gain,
             improved.moves, improved.moves == 0 ? 0.0 : (end - improving) / static_cast<double>(improved.moves),
             row.tour_s, after_sample - before_sample, gain(sampled_tour.runs), sort_s, row.sort_gain,
             gain(first_runs));
  static_cast<void>(std::fflush(stdout));
  return row;
}

// `count` of the ids, as evenly as they go.
Ids spread(const Ids& ids, std::size_t count) {
  Ids result;
  for (std::size_t i = 0; i < count; ++i) result.push_back(ids[i * ids.size() / count]);
  return result;
}

double sort_many(std::uint32_t count) {
  std::mt19937_64 random(1);
  std::vector<Node> nodes(100'000);
  for (std::uint32_t id = 0; id < count; ++id)
    for (std::size_t n = random() % nodes.size(), i = 0; i < 3 && n < nodes.size(); ++i, n += 1 + random() % 1000)
      nodes[n].added.push_back(id);
  const double start = seconds();
  const std::vector<std::uint32_t> places = sorted_places(nodes, count, false);
  return places.empty() ? 0.0 : seconds() - start;
}

// --- codes

// Ours in whole bytes, with what says how long they are; the others without.
struct Bits {
  std::size_t ids = 0, vector = 0, integers = 0, delimiter = 0, delimiter_runs = 0, huffman_runs = 0, ours = 0;
};

Bits bits_of(const std::vector<Ids>& lists, std::uint32_t id_count) {
  Bits bits;
  for (const Ids& list : lists) {
    const std::vector<std::uint32_t> runs = paper::runs_of(list);
    const std::vector<std::uint64_t> wide(list.begin(), list.end());
    BitWriter writer;
    put_set(writer, wide);
    bits.ids += list.size();
    bits.vector += id_count;
    bits.integers += 32 * list.size();
    bits.delimiter += paper::encode_delimited(paper::gaps_of(list)).size();
    bits.delimiter_runs += paper::encode_delimited(runs).size();
    bits.huffman_runs += paper::encode_adaptive(runs).size();
    bits.ours += 8 * writer.take().size();
  }
  return bits;
}

void print_bits(const char* order, const std::vector<Ids>& lists, const Bits& bits) {
  const auto an_id = [&](std::size_t n) { return static_cast<double>(n) / static_cast<double>(bits.ids); };
  fmt::print("{},{},{},{},{:.0f},{:.1f},{:.2f},{:.2f},{:.2f},{:.2f}\n", order, lists.size(), bits.ids,
             count_runs(lists), an_id(bits.vector), an_id(bits.integers), an_id(bits.delimiter),
             an_id(bits.delimiter_runs), an_id(bits.huffman_runs), an_id(bits.ours));
}

// --- crossings

// Bytes that are read when the eye goes from a cell to the next: of the tree the nodes of the new path that the old has
// not; of neighbours' deltas both lists in the paper's code.
// Gives the bytes of all nodes and the ratio of what is read.
std::pair<std::size_t, double> print_crossings(const std::vector<Transition>& transitions, const CellSubtree& tree) {
  const auto leaf_at = [&](glm::ivec2 cell) {
    for (std::size_t n = 0; n < tree.nodes.size(); ++n)
      if (tree.nodes[n].end == n + 1 && tree.nodes[n].box.min == glm::dvec3(cell, 0)) return static_cast<CellId>(n);
    return no_id;
  };
  const auto bytes_below = [&](CellId from, CellId to) {
    std::size_t bytes = 0;
    for (CellId n = to; n != no_id && !(n <= from && from < tree.nodes[n].end); n = tree.nodes[n].parent)
      bytes += tree.nodes[n].payload_bytes;
    return bytes;
  };
  const auto delta_bytes = [](const Ids& list) {
    return (paper::encode_delimited(paper::runs_of(list)).size() + 7) / 8;
  };
  std::size_t deltas = 0, additions = 0, stored = 0;
  for (const Transition& t : transitions) {
    const std::size_t bytes = delta_bytes(t.delta.added) + delta_bytes(t.delta.removed);
    const CellId from = leaf_at(t.from_cell), to = leaf_at(t.to_cell);
    deltas += 2 * bytes;  // there and back
    additions += bytes_below(from, to) + bytes_below(to, from);
    stored += bytes;
  }
  std::size_t tree_bytes = 0;
  for (const CellNode& node : tree.nodes) tree_bytes += node.payload_bytes;
  const auto crossings = 2.0 * static_cast<double>(transitions.size());
  fmt::print("crossings,bytes_a_crossing_deltas,bytes_a_crossing_tree,ratio,stored_deltas,stored_tree\n");
  fmt::print("{},{:.0f},{:.0f},{:.3f},{},{}\n", 2 * transitions.size(), static_cast<double>(deltas) / crossings,
             static_cast<double>(additions) / crossings, static_cast<double>(additions) / static_cast<double>(deltas),
             stored, tree_bytes);
  return {tree_bytes, static_cast<double>(additions) / static_cast<double>(deltas)};
}

void run(int side, std::size_t most_columns, std::uint32_t many) {
  const Grid grid = build_grid(side);
  const Tree tree(grid);
  const std::vector<Transition> transitions = transitions_of(grid, tree);
  const std::vector<Ids> lists = lists_of(transitions);
  std::vector<bool> is_used(grid.split_count, false);
  for (const Ids& list : lists)
    for (const std::uint32_t id : list) is_used[id] = true;
  Ids used;
  for (std::uint32_t id = 0; id < grid.split_count; ++id)
    if (is_used[id]) used.push_back(id);
  std::size_t in_cells = 0, cells = 0;
  for (const auto& cell : grid.cells) {
    in_cells += cell ? cell->size() : 0;
    cells += cell ? 1U : 0U;
  }
  fmt::print("cells,splits,splits_in_a_cell,transitions,lists,ids_in_a_list,splits_in_lists\n");
  std::size_t ids = 0;
  for (const Ids& list : lists) ids += list.size();
  fmt::print("{},{},{},{},{},{},{}\n\n", cells, grid.split_count, in_cells / cells, transitions.size(), lists.size(),
             ids / lists.size(), used.size());

  fmt::print(
      "columns,rows,runs,knn_s,seed_s,fewer_runs_seed,fewer_runs_tour,moves,s_a_move,tour_s,sample_knn_s,"
      "fewer_runs_sample_tour,sort_s,fewer_runs_sort,fewer_runs_first_node\n");
  TableRow last;
  for (const std::size_t columns : {500U, 1000U, 3000U, 9000U, 27000U})
    if (columns <= std::min(used.size(), most_columns))
      last = print_table_row(lists, tree.nodes(), spread(used, columns));
  if (used.size() <= most_columns) last = print_table_row(lists, tree.nodes(), used);

  const std::vector<std::uint32_t> places = sorted_places(tree.nodes(), grid.split_count, false);
  const std::vector<Ids> sorted = renumbered(lists, places);
  fmt::print("\norder,lists,ids,runs,bit_vector,int32,delimiter,delimiter_runs,adaptive_huffman_runs,ours\n");
  const Bits before = bits_of(lists, grid.split_count), after = bits_of(sorted, grid.split_count);
  print_bits("crossings as built", lists, before);
  print_bits("crossings sorted", sorted, after);
  std::vector<Ids> additions;
  for (const Node& node : tree.nodes())
    if (!node.added.empty()) additions.push_back(node.added);
  const Bits in_tree = bits_of(additions, grid.split_count);
  print_bits("tree as built", additions, in_tree);
  const std::vector<Ids> sorted_additions = renumbered(additions, places);
  print_bits("tree sorted", sorted_additions, bits_of(sorted_additions, grid.split_count));
  fmt::print("\n");
  CellSubtree packed = packed_tree(grid, 0, 0, side);
  finish(packed);
  const auto [tree_bytes, read_ratio] = print_crossings(transitions, packed);

  const auto ratio = [](std::size_t a, std::size_t b) { return static_cast<double>(a) / static_cast<double>(b); };
  fmt::print("\ngoal,measure,asked,is\n");
  fmt::print("8,bytes a crossing over deltas',<= 0.5,{:.3f}\n", read_ratio);
  fmt::print("9,bits of the tree's files over the paper's code of its lists,<= 0.7,{:.3f}\n",
             ratio(8 * tree_bytes, in_tree.delimiter_runs));
  fmt::print("9,bits over the paper's code as built,<= 0.7,{:.3f}\n", ratio(before.ours, before.delimiter_runs));
  fmt::print("9,bits over the paper's code sorted,<= 0.7,{:.3f}\n", ratio(after.ours, after.delimiter_runs));
  fmt::print("9,bits over bit vectors as built,<= 0.01,{:.4f}\n", ratio(before.ours, before.vector));
  fmt::print("9,bits over bit vectors sorted,<= 0.01,{:.4f}\n", ratio(after.ours, after.vector));
  fmt::print("10,fewer runs by the sort,>= 6,{:.2f}\n", ratio(count_runs(lists), count_runs(sorted)));
  fmt::print("10,fewer runs by the sort over by the tour,>= 1,{:.2f}\n", last.sort_gain / last.tour_gain);
  fmt::print("10,its time over the tour's,<= 0.01,{:.6f}\n", last.sort_s / last.tour_s);
  fmt::print("10,s for {} splits,<= 60,{:.1f}\n", many, sort_many(many));
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) {
  CLI::App app("Order and codes of the splits of view cells, beside the methods of vLOD (2003).");
  int side = 32;
  std::size_t most_columns = 30'000;
  std::uint32_t many = 25'000'000;
  app.add_option("--side", side, "Cells along each side of the grid, a power of two")
      ->check(CLI::IsMember({4, 8, 16, 32}));
  app.add_option("--columns", most_columns, "Columns of Table 1, at most");
  app.add_option("--sort", many, "Splits to sort at the end");
  CLI11_PARSE(app, argc, argv);
  occlod::bench::run(side, most_columns, many);
  return 0;
}
