#include "hlod/build/join_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

#include "splits/parallel.h"

namespace occlod::hlod {
namespace {

using CellId = std::uint32_t;

// Two cells that meet at a vertex.
struct Link {
  CellId a = 0, b = 0;  // a < b
  friend bool operator==(const Link&, const Link&) = default;
  friend bool operator<(const Link& x, const Link& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); }
};

// One for each vertex and two cells that follow each other among the vertex's cells: where many meet, a chain of links
// is enough to join them. Each thread scans all triangles and handles the vertices of its part.
LargeVector<Link> find_links(const Cells& cells, std::span<const Triangle> triangles, std::size_t vertex_count,
                             unsigned threads) {
  LargeVector<CellId> last_cell(vertex_count, no_id);
  std::vector<LargeVector<Link>> parts(threads);
  for_each_part(vertex_count, threads, [&](std::size_t begin, std::size_t end, std::size_t part) {
    const auto meet = [&](VertexId v, CellId cell) {
      if (v < begin || v >= end || last_cell[v] == cell) return;
      if (last_cell[v] != no_id) parts[part].push_back({last_cell[v], cell});
      last_cell[v] = cell;
    };
    for_each_id(cells.leaf_count(), 1, [&](CellId cell) {
      make_room();
      for (std::uint32_t i = cells.first_item[cell]; i < cells.first_item[cell + 1]; ++i)
        for (int k = 0; k < 3; ++k) meet(triangles[cells.order[i]][k], cell);
    });
  });
  LargeVector<Link> links;
  for (const LargeVector<Link>& part : parts) links.insert(links.end(), part.begin(), part.end());
  std::sort(links.begin(), links.end());
  return links;
}

// Two groups that might be joined. Out of date when either has changed since.
struct Candidate {
  double score = 0.0;
  CellId a = 0, b = 0;
  std::uint32_t version_a = 0, version_b = 0;

  friend bool operator<(const Candidate& x, const Candidate& y) {
    return std::tuple(x.score, y.a, y.b) < std::tuple(y.score, x.a, x.b);  // the first cells first
  }
};

// A group is named by its first cell.
class CellJoiner {
 public:
  CellJoiner(const Cells& cells, std::span<const Link> links, std::uint32_t most_triangles)
      : cells_(cells),
        most_triangles_(most_triangles),
        joined_to_(cells.leaf_count()),
        size_(cells.leaf_count()),
        version_(cells.leaf_count(), 0),
        cell_now_(cells.leaf_count(), no_id),
        neighbours_(cells.leaf_count()) {
    std::iota(joined_to_.begin(), joined_to_.end(), 0U);
    for (CellId cell = 0; cell < cells.leaf_count(); ++cell) size_[cell] = cells.item_count(cell);
    for (std::size_t i = 0; i < links.size();) {
      std::size_t end = i;
      while (end < links.size() && links[end] == links[i]) ++end;
      neighbours_[links[i].a].push_back({links[i].b, end - i});
      neighbours_[links[i].b].push_back({links[i].a, end - i});
      i = end;
    }
  }

  CellGroups run() {
    std::vector<CellId> waiting;
    CellId next_leaf = 0;
    for (std::uint32_t i = 0; i < cells_.inner.size(); ++i) {
      const LeafRange leaves = cells_.inner[i];
      while (next_leaf < leaves.end) waiting.push_back(next_leaf++);
      auto first = waiting.end();  // all groups of the cell wait behind those of cells before it
      while (first != waiting.begin() && *(first - 1) >= leaves.first) --first;
      std::vector<CellId> groups(first, waiting.end());
      waiting.erase(first, waiting.end());
      join(groups, i);
      for (const CellId group : groups)
        if (joined_to_[group] == group && 2 * size_[group] < most_triangles_) waiting.push_back(group);
    }
    return number();
  }

 private:
  struct Neighbour {
    CellId group = 0;
    std::size_t shared = 0;  // vertices
  };

  void join(const std::vector<CellId>& groups, std::uint32_t cell) {
    for (const CellId group : groups) cell_now_[group] = cell;
    for (const CellId group : groups) propose(group, cell, [&](CellId other) { return group < other; });
    while (!queue_.empty()) {
      const Candidate best = queue_.top();
      queue_.pop();
      if (version_[best.a] != best.version_a || version_[best.b] != best.version_b) continue;
      merge(best.a, best.b);
      propose(best.a, cell, [](CellId) { return true; });
    }
  }

  template <typename Wanted>
  void propose(CellId group, std::uint32_t cell, const Wanted& wanted) {
    for (const Neighbour& n : neighbours_[group]) {
      if (cell_now_[n.group] != cell || !wanted(n.group) || size_[group] + size_[n.group] > most_triangles_) continue;
      const double smaller = std::min(size_[group], size_[n.group]);
      const CellId a = std::min(group, n.group), b = std::max(group, n.group);
      queue_.push({static_cast<double>(n.shared) / std::sqrt(smaller), a, b, version_[a], version_[b]});
    }
  }

  // b goes.
  void merge(CellId a, CellId b) {
    joined_to_[b] = a;
    size_[a] += size_[b];
    ++version_[a];
    ++version_[b];
    cell_now_[b] = no_id;
    std::erase_if(neighbours_[a], [&](const Neighbour& n) { return n.group == b; });
    for (const Neighbour& n : neighbours_[b]) {
      if (n.group == a) continue;
      std::erase_if(neighbours_[n.group], [&](const Neighbour& back) { return back.group == b; });
      add(a, n.group, n.shared);
      add(n.group, a, n.shared);
    }
    neighbours_[b] = {};
  }

  void add(CellId group, CellId other, std::size_t shared) {
    for (Neighbour& n : neighbours_[group])
      if (n.group == other) {
        n.shared += shared;
        return;
      }
    neighbours_[group].push_back({other, shared});
  }

  CellGroups number() {
    CellGroups result;
    result.group_of.resize(cells_.leaf_count());
    for (CellId cell = 0; cell < cells_.leaf_count(); ++cell)  // a cell is joined to one before it
      result.group_of[cell] = joined_to_[cell] == cell ? result.count++ : result.group_of[joined_to_[cell]];
    return result;
  }

  const Cells& cells_;
  std::uint32_t most_triangles_;
  std::vector<CellId> joined_to_;
  std::vector<std::uint32_t> size_;      // triangles
  std::vector<std::uint32_t> version_;   // counts changes
  std::vector<std::uint32_t> cell_now_;  // the inner cell in which the group may be joined
  std::vector<std::vector<Neighbour>> neighbours_;
  std::priority_queue<Candidate> queue_;
};

}  // namespace

CellGroups join_cells(const Cells& cells, std::span<const Triangle> triangles, std::size_t vertex_count,
                      std::uint32_t most_triangles, unsigned threads) {
  const LargeVector<Link> links = find_links(cells, triangles, vertex_count, threads);
  return CellJoiner(cells, links, most_triangles).run();
}

CellGroups separate_cells(const Cells& cells) {
  CellGroups groups{std::vector<std::uint32_t>(cells.leaf_count()), cells.leaf_count()};
  std::iota(groups.group_of.begin(), groups.group_of.end(), 0U);
  return groups;
}

}  // namespace occlod::hlod
