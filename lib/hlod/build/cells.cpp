#include "hlod/build/cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

#include "base/threads.h"
#include "splits/spatial_order.h"

namespace occlod::hlod {
namespace {

constexpr std::uint32_t units_of_third = 1U << 20U;
constexpr std::uint32_t units = 3 * units_of_third;  // in W

// Spreads the lower 21 bits of x to every third bit.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32U) & 0x001f00000000ffffU;
  x = (x | x << 16U) & 0x001f0000ff0000ffU;
  x = (x | x << 8U) & 0x100f00f00f00f00fU;
  x = (x | x << 4U) & 0x10c30c30c30c30c3U;
  return (x | x << 2U) & 0x1249249249249249U;
}

}  // namespace

OctreeGrid::OctreeGrid(const Box& box) : origin_(box.min) {
  const glm::dvec3 size = glm::dvec3(box.max) - origin_;
  const double extent = std::max({size.x, size.y, size.z});
  if (extent > 0.0) units_per_length_ = units / extent;
}

std::uint64_t OctreeGrid::code(const glm::dvec3& p, unsigned thirds) const {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double x = std::clamp((p[axis] - origin_[axis]) * units_per_length_, 0.0, static_cast<double>(units - 1));
    const std::uint32_t moved = static_cast<std::uint32_t>(x) + thirds * units_of_third;
    code |= spread(moved / 3) << static_cast<unsigned>(axis);  // cells of the finest level are 3 units wide
  }
  return code;
}

namespace {

constexpr unsigned key_bits = 30;  // the highest bits of the codes, by which items are sorted first

class CellMaker {
 public:
  CellMaker(std::span<const std::uint64_t> codes, std::uint32_t max_items, std::span<const std::uint32_t> unit_of,
            unsigned threads)
      : codes_(codes), max_items_(max_items), unit_of_(unit_of) {
    sort(threads);
  }

  Cells run() {
    split(0, static_cast<std::uint32_t>(cells_.order.size()), 0);
    cells_.first_item.push_back(static_cast<std::uint32_t>(cells_.order.size()));
    return std::move(cells_);
  }

 private:
  void sort(unsigned threads) {
    UninitializedVector<Keyed> keyed(codes_.size());
    for_each_id(codes_.size(), threads, [&](std::uint32_t i) {
      keyed[i] = {static_cast<std::uint32_t>(codes_[i] >> (3 * OctreeGrid::depth - key_bits)), i};
    });
    sort_by_key(keyed, key_bits, threads);
    cells_.order.resize(codes_.size());
    for_each_id(codes_.size(), threads, [&](std::uint32_t i) { cells_.order[i] = keyed[i].item; });
  }

  // Splits the cell that holds the items [begin, end) of the order.
  void split(std::uint32_t begin, std::uint32_t end, unsigned depth) {
    if (begin == end) return;
    if (end - begin <= max_items_) return add_leaf(begin);
    if (3 * depth == key_bits) sort_further(begin, end);
    if (depth == OctreeGrid::depth) return cut(begin, end);
    const auto first_leaf = static_cast<std::uint32_t>(cells_.first_item.size());
    for (unsigned octant = 0; octant < 8; ++octant) {
      const auto in_octant = [&](std::uint32_t item) { return OctreeGrid::octant(codes_[item], depth + 1) <= octant; };
      const auto next = std::partition_point(cells_.order.begin() + begin, cells_.order.begin() + end, in_octant);
      const auto after = static_cast<std::uint32_t>(next - cells_.order.begin());
      split(begin, after, depth + 1);
      begin = after;
    }
    cells_.inner.push_back({first_leaf, static_cast<std::uint32_t>(cells_.first_item.size())});
  }

  // Sorts items whose keys do not tell them apart by their whole codes.
  void sort_further(std::uint32_t begin, std::uint32_t end) {
    std::sort(cells_.order.begin() + begin, cells_.order.begin() + end,
              [&](std::uint32_t a, std::uint32_t b) { return codes_[a] != codes_[b] ? codes_[a] < codes_[b] : a < b; });
  }

  // Cuts the items of a finest cell into leaves.
  void cut(std::uint32_t begin, std::uint32_t end) {
    const auto first_leaf = static_cast<std::uint32_t>(cells_.first_item.size());
    while (begin < end) {
      add_leaf(begin);
      std::uint32_t next = std::min(end, begin + max_items_);
      if (next < end && !unit_of_.empty()) {
        std::uint32_t unit_begin = next;
        while (unit_begin > begin && unit(unit_begin - 1) == unit(next)) --unit_begin;
        if (unit_begin > begin) next = unit_begin;
      }
      begin = next;
    }
    cells_.inner.push_back({first_leaf, static_cast<std::uint32_t>(cells_.first_item.size())});
  }

  [[nodiscard]] std::uint32_t unit(std::uint32_t place) const { return unit_of_[cells_.order[place]]; }
  void add_leaf(std::uint32_t begin) { cells_.first_item.push_back(begin); }

  std::span<const std::uint64_t> codes_;
  std::uint32_t max_items_;
  std::span<const std::uint32_t> unit_of_;
  Cells cells_;
};

}  // namespace

Cells make_cells(std::span<const std::uint64_t> codes, std::uint32_t max_items, std::span<const std::uint32_t> unit_of,
                 unsigned threads) {
  return CellMaker(codes, max_items, unit_of, threads).run();
}

namespace {

using CellId = std::uint32_t;

// Records that two cells meet at a vertex.
struct Link {
  CellId a = 0, b = 0;  // a < b
  friend bool operator==(const Link&, const Link&) = default;
  friend bool operator<(const Link& x, const Link& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); }
};

// Returns a link for each two consecutive cells of a vertex: where many cells meet, a chain of links is enough to join
// them. Each thread scans all triangles and handles the vertices of its part.
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

// Names two groups that might be joined. It is out of date when either has changed since.
struct Candidate {
  double score = 0.0;
  CellId a = 0, b = 0;
  std::uint32_t version_a = 0, version_b = 0;

  friend bool operator<(const Candidate& x, const Candidate& y) {
    return std::tuple(x.score, y.a, y.b) < std::tuple(y.score, x.a, x.b);  // earlier cells first
  }
};

// A group is named by its first cell.
class CellJoiner {
 public:
  CellJoiner(const Cells& cells, std::span<const Link> links, std::uint32_t max_triangles)
      : cells_(cells),
        max_triangles_(max_triangles),
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
      auto first = waiting.end();  // all groups of the cell wait behind those of earlier cells
      while (first != waiting.begin() && *(first - 1) >= leaves.first) --first;
      std::vector<CellId> groups(first, waiting.end());
      waiting.erase(first, waiting.end());
      join(groups, i);
      for (const CellId group : groups)
        if (joined_to_[group] == group && 2 * size_[group] < max_triangles_) waiting.push_back(group);
    }
    return number();
  }

 private:
  struct Neighbour {
    CellId group = 0;
    std::size_t shared = 0;  // number of vertices
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
      if (cell_now_[n.group] != cell || !wanted(n.group) || size_[group] + size_[n.group] > max_triangles_) continue;
      const double smaller = std::min(size_[group], size_[n.group]);
      const CellId a = std::min(group, n.group), b = std::max(group, n.group);
      queue_.push({static_cast<double>(n.shared) / std::sqrt(smaller), a, b, version_[a], version_[b]});
    }
  }

  // Joins group b to a. b is no longer a group.
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
    for (CellId cell = 0; cell < cells_.leaf_count(); ++cell)  // a cell is joined to an earlier one
      result.group_of[cell] = joined_to_[cell] == cell ? result.count++ : result.group_of[joined_to_[cell]];
    return result;
  }

  const Cells& cells_;
  std::uint32_t max_triangles_;
  std::vector<CellId> joined_to_;
  std::vector<std::uint32_t> size_;      // number of triangles
  std::vector<std::uint32_t> version_;   // number of changes
  std::vector<std::uint32_t> cell_now_;  // inner cell in which the group may be joined
  std::vector<std::vector<Neighbour>> neighbours_;
  std::priority_queue<Candidate> queue_;
};

}  // namespace

CellGroups join_cells(const Cells& cells, std::span<const Triangle> triangles, std::size_t vertex_count,
                      std::uint32_t max_triangles, unsigned threads) {
  const LargeVector<Link> links = find_links(cells, triangles, vertex_count, threads);
  return CellJoiner(cells, links, max_triangles).run();
}

CellGroups separate_cells(const Cells& cells) {
  CellGroups groups{std::vector<std::uint32_t>(cells.leaf_count()), cells.leaf_count()};
  std::iota(groups.group_of.begin(), groups.group_of.end(), 0U);
  return groups;
}

}  // namespace occlod::hlod
