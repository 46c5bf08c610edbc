// bench_cell_order: lists of splits of the cells of a grid. Their order by the tour of vLOD (2003), Table 1, and by our
// sort; their codes; and what is read when the eye goes from a cell to the next.
#include <fmt/format.h>
#include <zstd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "cells/packed_numbers.h"
#include "cells/vlod_payload.h"
#include "papers/adaptive_huffman.h"
#include "papers/delimiter_code.h"
#include "papers/first_node.h"
#include "papers/hamming_tour.h"
#include "support/ball_shares.h"
#include "support/cell_lists.h"
#include "support/cpu_clock.h"

namespace occlod::bench {
namespace {

using paper::Order;

constexpr std::uint32_t max_neighbours = 20;
constexpr std::size_t max_moves = 500'000;

double seconds() { return 1e-3 * thread_cpu_ms(); }

// --- order

// All lists of a crossing, in either direction.
std::vector<Ids> lists_of(const std::vector<Transition>& transitions) {
  std::vector<Ids> lists;
  for (const Transition& t : transitions)
    for (const Ids* list : {&t.delta.added, &t.delta.removed})
      if (!list->empty()) lists.push_back(*list);
  return lists;
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
  std::vector<Ids> added;  // by the nodes of the tree
};

Part part_of(const std::vector<Ids>& lists, const std::vector<Ids>& added, const Ids& kept) {
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
  for (const Ids& ids : added) part.added.push_back(keep(ids));
  return part;
}

paper::BitColumns columns_of(const Part& part, std::size_t count) {
  std::vector<std::vector<std::uint32_t>> rows(count);
  for (std::uint32_t row = 0; row < part.lists.size(); ++row)
    for (const std::uint32_t column : part.lists[row]) rows[column].push_back(row);
  return paper::BitColumns(rows);
}

struct TableRow {
  double tour_s = 0.0, sort_s = 0.0, tour_gain = 0.0, sort_gain = 0.0;
};

TableRow print_table_row(const std::vector<Ids>& lists, const std::vector<Ids>& added, const Ids& kept) {
  const Part part = part_of(lists, added, kept);
  const paper::BitColumns columns = columns_of(part, kept.size());
  const auto count = static_cast<std::uint32_t>(kept.size());
  const std::size_t before = count_runs(part.lists);
  const auto gain = [&](std::size_t runs) { return static_cast<double>(before) / static_cast<double>(runs); };

  const double start = seconds();
  const paper::Neighbours near = paper::nearest_columns(columns, max_neighbours);
  const double after_near = seconds();
  Order order = paper::greedy_tour(columns, near);
  const double after_seed = seconds();
  const std::size_t seed_runs = paper::count_runs(columns, order);
  const double improving = seconds();
  const paper::Improvement improved = paper::improve_tour(columns, near, order, max_moves);
  const double end = seconds();

  // By one common sample instead.
  const auto sample_size = static_cast<std::uint32_t>(20.0 * std::log(static_cast<double>(count)));
  const double before_sample = seconds();
  const paper::Neighbours sampled =
      paper::nearest_of_sample(columns, max_neighbours, paper::sample_columns(columns, sample_size, 1));
  const double after_sample = seconds();
  Order sampled_order = paper::greedy_tour(columns, sampled);
  const paper::Improvement sampled_tour = paper::improve_tour(columns, sampled, sampled_order, max_moves);

  const double before_sort = seconds();
  const std::vector<std::uint32_t> places = places_by_nodes(part.added, count);
  const double sort_s = seconds() - before_sort;
  const std::size_t sorted_runs = count_runs(renumbered(part.lists, places));
  const std::size_t first_runs = count_runs(renumbered(part.lists, paper::places_by_first_node(part.added, count)));

  const TableRow row{after_seed - start + end - improving, sort_s, gain(improved.runs), gain(sorted_runs)};
  fmt::print("{},{},{},{:.3f},{:.3f},{:.2f},{:.2f},{},{:.3g},{:.3f},{:.4f},{:.2f},{:.6f},{:.2f},{:.2f}\n", count,
             part.lists.size(), before, after_near - start, after_seed - after_near, gain(seed_runs), row.tour_gain,
             improved.moves, improved.moves == 0 ? 0.0 : (end - improving) / static_cast<double>(improved.moves),
             row.tour_s, after_sample - before_sample, gain(sampled_tour.runs), sort_s, row.sort_gain,
             gain(first_runs));
  static_cast<void>(std::fflush(stdout));
  return row;
}

constexpr std::array ball_factors{1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0};
constexpr std::uint32_t max_centres = 500;

// Figure 4: how much of all columns is near to one.
void print_balls(const std::vector<Ids>& lists, const Ids& kept) {
  const BallShares balls = ball_shares(columns_of(part_of(lists, {}, kept), kept.size()), ball_factors, max_centres);
  for (std::size_t k = 0; k < ball_factors.size(); ++k)
    fmt::print("{},{},{},{:.1f},{:.3f},{:.3f}\n", kept.size(), ball_factors[k], balls.centres,
               100.0 * balls.equal_share, 100.0 * balls.mean[k], 100.0 * balls.least[k]);
}

// `count` of the ids, as evenly as they go.
Ids spread(const Ids& ids, std::size_t count) {
  Ids result;
  for (std::size_t i = 0; i < count; ++i) result.push_back(ids[i * ids.size() / count]);
  return result;
}

double sort_many(std::uint32_t count) {
  std::mt19937_64 random(1);
  std::vector<Ids> nodes(100'000);
  for (std::uint32_t id = 0; id < count; ++id)
    for (std::size_t n = random() % nodes.size(), i = 0; i < 3 && n < nodes.size(); ++i, n += 1 + random() % 1000)
      nodes[n].push_back(id);
  const double start = seconds();
  const std::vector<std::uint32_t> places = places_by_nodes(nodes, count);
  return places.empty() ? 0.0 : seconds() - start;
}

// --- codes

// Ours in whole bytes, with what says how long they are; the others without.
struct Bits {
  std::size_t ids = 0, vector = 0, integers = 0, delimiter = 0, delimiter_runs = 0, paper = 0, huffman_runs = 0,
              zstd_runs = 0, ours = 0;
};

// The delimiter code of gaps, or of runs where that is shorter: the paper takes runs where ids follow one another.
std::size_t paper_bits(const Ids& list) {
  return std::min(paper::encode_delimited(paper::gaps_of(list)).size(),
                  paper::encode_delimited(paper::runs_of(list)).size());
}

void put_varint(std::vector<std::uint8_t>& bytes, std::uint32_t number) {
  for (; number >= 128; number >>= 7U) bytes.push_back(static_cast<std::uint8_t>(number | 128U));
  bytes.push_back(static_cast<std::uint8_t>(number));
}

// All lists as one frame, at the level that compresses best: no file could be read list by list like that.
std::size_t zstd_bits(const std::vector<std::uint8_t>& bytes) {
  std::vector<std::uint8_t> packed(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 19);
  if (ZSTD_isError(size) != 0) throw std::runtime_error(ZSTD_getErrorName(size));
  return 8 * size;
}

Bits bits_of(const std::vector<Ids>& lists, std::uint32_t id_count) {
  Bits bits;
  std::vector<std::uint8_t> bytes;
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
    bits.paper += paper_bits(list);
    bits.huffman_runs += paper::encode_adaptive(runs).size();
    bits.ours += 8 * writer.take().size();
    for (const std::uint32_t number : runs) put_varint(bytes, number);
  }
  bits.zstd_runs = zstd_bits(bytes);
  return bits;
}

void print_bits(const char* order, const std::vector<Ids>& lists, const Bits& bits) {
  const auto an_id = [&](std::size_t n) { return static_cast<double>(n) / static_cast<double>(bits.ids); };
  fmt::print("{},{},{},{},{:.0f},{:.1f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f}\n", order, lists.size(), bits.ids,
             count_runs(lists), an_id(bits.vector), an_id(bits.integers), an_id(bits.delimiter),
             an_id(bits.delimiter_runs), an_id(bits.paper), an_id(bits.huffman_runs), an_id(bits.zstd_runs),
             an_id(bits.ours));
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
  const auto delta_bytes = [](const Ids& list) { return (paper_bits(list) + 7) / 8; };
  std::size_t deltas = 0, additions = 0, stored = 0;
  for (const Transition& t : transitions) {
    const std::size_t bytes = delta_bytes(t.delta.added) + delta_bytes(t.delta.removed);
    const CellId from = leaf_at(t.from), to = leaf_at(t.to);
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

void run(int side, std::size_t max_columns, std::uint32_t many) {
  const CellGrid grid = build_grid(side);
  const std::vector<Ids> added = tree_additions(grid);
  const std::vector<Transition> transitions = transitions_of(grid);
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
  std::vector<Ids> matrices;
  for (const std::size_t columns : {500U, 1000U, 3000U, 9000U, 27000U})
    if (columns <= std::min(used.size(), max_columns)) matrices.push_back(spread(used, columns));
  if (used.size() <= max_columns) matrices.push_back(used);
  for (const Ids& kept : matrices) last = print_table_row(lists, added, kept);

  const std::vector<std::uint32_t> places = places_by_nodes(added, grid.split_count);
  const std::vector<Ids> sorted = renumbered(lists, places);
  fmt::print(
      "\norder,lists,ids,runs,bit_vector,int32,delimiter,delimiter_runs,delimiter_shorter,adaptive_huffman_runs,"
      "zstd_runs,ours\n");
  const Bits before = bits_of(lists, grid.split_count), after = bits_of(sorted, grid.split_count);
  print_bits("crossings as built", lists, before);
  print_bits("crossings sorted", sorted, after);
  std::vector<Ids> additions;
  for (const Ids& list : added)
    if (!list.empty()) additions.push_back(list);
  const Bits in_tree = bits_of(additions, grid.split_count);
  print_bits("tree as built", additions, in_tree);
  const std::vector<Ids> sorted_additions = renumbered(additions, places);
  print_bits("tree sorted", sorted_additions, bits_of(sorted_additions, grid.split_count));
  fmt::print("\n");
  const auto [tree_bytes, read_ratio] = print_crossings(transitions, packed_tree(grid));

  const auto ratio = [](std::size_t a, std::size_t b) { return static_cast<double>(a) / static_cast<double>(b); };
  fmt::print("\ncolumns,within,centres,equal_pct,share_mean_pct,share_least_pct\n");
  for (const Ids& kept : matrices) print_balls(lists, kept);

  fmt::print("\ngoal,measure,asked,is\n");
  fmt::print("8,bytes a crossing over those of deltas,<= 0.5,{:.3f}\n", read_ratio);
  fmt::print("9,bits of the tree's files over the paper's code of its lists,<= 0.7,{:.3f}\n",
             ratio(8 * tree_bytes, in_tree.paper));
  fmt::print("9,bits over the paper's code as built,<= 0.7,{:.3f}\n", ratio(before.ours, before.paper));
  fmt::print("9,bits over the paper's code sorted,<= 0.7,{:.3f}\n", ratio(after.ours, after.paper));
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
  std::size_t max_columns = 30'000;
  std::uint32_t many = 25'000'000;
  app.add_option("--side", side, "Cells along each side of the grid, a power of two")
      ->check(CLI::IsMember({4, 8, 16, 32}));
  app.add_option("--columns", max_columns, "Columns of Table 1, at most");
  app.add_option("--sort", many, "Splits to sort at the end");
  CLI11_PARSE(app, argc, argv);
  occlod::bench::run(side, max_columns, many);
  return 0;
}
