#include "hlod/build/group_triangles.h"

#include <algorithm>
#include <deque>
#include <numeric>
#include <utility>
#include <vector>

#include "base/threads.h"
#include "hlod/build/cells.h"

namespace occlod::hlod {

// Each thread scans all triangles and handles the vertices of its part.
LargeVector<std::uint8_t> shared_vertices(std::span<const Triangle> triangles, std::span<const std::uint32_t> group_of,
                                          std::size_t vertex_count, unsigned threads) {
  LargeVector<std::uint8_t> shared(vertex_count, 0);
  LargeVector<std::uint32_t> first_user(vertex_count, no_id);
  for_each_part(vertex_count, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
    for_each_id(triangles.size(), 1, [&](std::uint32_t t) {
      for (int k = 0; k < 3; ++k) {
        const VertexId v = triangles[t][k];
        if (v < begin || v >= end) continue;
        if (first_user[v] == no_id) first_user[v] = group_of[t];
        if (first_user[v] != group_of[t]) shared[v] = 1;
      }
    });
  });
  return shared;
}

namespace {

TriangleGroups by_triangle(const Cells& cells, const CellGroups& groups, unsigned threads) {
  TriangleGroups result{UninitializedVector<std::uint32_t>(cells.order.size()), groups.count};
  for_each_id(cells.leaf_count(), threads, [&](std::uint32_t cell) {
    make_room();
    for (std::uint32_t i = cells.first_item[cell]; i < cells.first_item[cell + 1]; ++i)
      result.group_of[cells.order[i]] = groups.group_of[cell];
  });
  return result;
}

}  // namespace

TriangleGrouping::TriangleGrouping(const WedgeMesh& mesh, Grouping grouping, const Reduction& reduction,
                                   unsigned threads)
    : mesh_(mesh), grouping_(grouping), reduction_(reduction), threads_(threads), grid_(bounding_box(mesh.positions)) {}

glm::dvec3 TriangleGrouping::centroid(const Triangle& t) const {
  return (glm::dvec3(mesh_.positions[t.x]) + glm::dvec3(mesh_.positions[t.y]) + glm::dvec3(mesh_.positions[t.z])) / 3.0;
}

UninitializedVector<std::uint64_t> TriangleGrouping::codes_of(std::span<const Triangle> triangles,
                                                              unsigned thirds) const {
  UninitializedVector<std::uint64_t> codes(triangles.size());
  for_each_id(triangles.size(), threads_,
              [&](std::uint32_t t) { codes[t] = grid_.code(centroid(triangles[t]), thirds); });
  return codes;
}

TriangleGroups TriangleGrouping::group(std::span<const std::uint64_t> codes, std::span<const Triangle> triangles,
                                       std::uint32_t max_triangles, std::span<const std::uint32_t> unit_of) const {
  const Cells cells = make_cells(codes, max_triangles, unit_of, threads_);
  if (grouping_ == Grouping::nested) return by_triangle(cells, separate_cells(cells), threads_);
  const std::size_t vertices = mesh_.vertex_count();
  TriangleGroups groups = by_triangle(cells, join_cells(cells, triangles, vertices, max_triangles, threads_), threads_);
  grow_stuck_groups(triangles, cells.order, vertices, max_triangles, groups, threads_);
  return groups;
}

TriangleGroups TriangleGrouping::group_input() const {
  const auto codes = codes_of(mesh_.triangles, 0);
  return group(codes, mesh_.triangles, reduction_.node_triangles, {});
}

TriangleGroups TriangleGrouping::group_level(const LevelDraft& below, unsigned level) {
  if (grouping_ == Grouping::nested) return group_nodes(below);
  const auto codes = codes_of(below.triangles, level % 3);
  TriangleGroups groups = group(codes, below.triangles, reduction_.group_triangles, {});
  if (below.nodes.size() > 1) move_slivers(below, reduction_, groups, threads_);
  return groups;
}

// All triangles of a node get its code, so that they end up in one cell.
TriangleGroups TriangleGrouping::group_nodes(const LevelDraft& below) {
  if (node_codes_.empty()) find_node_codes(below);
  UninitializedVector<std::uint64_t> codes(below.triangles.size());
  UninitializedVector<std::uint32_t> unit_of(below.triangles.size());
  for (std::uint32_t n = 0; n < below.nodes.size(); ++n) {
    make_room();
    const NodeDraft& node = below.nodes[n];
    std::fill_n(codes.begin() + node.first_triangle, node.triangle_count, node_codes_[n]);
    std::fill_n(unit_of.begin() + node.first_triangle, node.triangle_count, n);
  }
  return group(codes, below.triangles, reduction_.group_triangles, unit_of);
}

void TriangleGrouping::find_node_codes(const LevelDraft& input) {
  for (const NodeDraft& node : input.nodes)
    node_codes_.push_back(grid_.code(centroid(input.triangles[node.first_triangle]), 0));
}

// The code of a group is that of its last triangle.
void TriangleGrouping::finish_level(const LevelDraft& below, const TriangleGroups& groups) {
  if (grouping_ != Grouping::nested) return;
  if (node_codes_.empty()) find_node_codes(below);
  std::vector<std::uint64_t> codes_above(groups.count);
  for (std::uint32_t n = 0; n < below.nodes.size(); ++n) {
    make_room();
    const NodeDraft& node = below.nodes[n];
    for (std::uint32_t t = node.first_triangle; t < node.first_triangle + node.triangle_count; ++t)
      codes_above[groups.group_of[t]] = node_codes_[n];
  }
  node_codes_ = std::move(codes_above);
}

namespace {

// Returns, for each group, whether more than half of its corners are shared.
std::vector<bool> find_stuck(std::span<const Triangle> triangles, std::size_t vertex_count,
                             const TriangleGroups& groups, unsigned threads) {
  const auto shared = shared_vertices(triangles, groups.group_of, vertex_count, threads);
  std::vector<std::uint32_t> corners(groups.count, 0), shared_corners(groups.count, 0);
  for_each_id(triangles.size(), 1, [&](std::uint32_t t) {
    corners[groups.group_of[t]] += 3;
    for (int k = 0; k < 3; ++k) shared_corners[groups.group_of[t]] += shared[triangles[t][k]];
  });
  std::vector<bool> stuck(groups.count);
  for (std::size_t group = 0; group < stuck.size(); ++group) stuck[group] = 2 * shared_corners[group] > corners[group];
  return stuck;
}

// Lists the triangles at each vertex.
struct Incidences {
  LargeVector<std::uint32_t> first;  // those at v are [first[v], first[v + 1])
  LargeVector<std::uint32_t> triangle;

  Incidences(std::span<const Triangle> triangles, std::span<const std::uint32_t> members, std::size_t vertex_count)
      : first(vertex_count + 2, 0), triangle(3 * members.size()) {
    for_each_id(members.size(), 1, [&](std::uint32_t i) {
      for (int k = 0; k < 3; ++k) ++first[triangles[members[i]][k] + 2];
    });
    for (std::size_t v = 2; v < first.size(); ++v) first[v] += first[v - 1];
    for_each_id(members.size(), 1, [&](std::uint32_t i) {
      for (int k = 0; k < 3; ++k) triangle[first[triangles[members[i]][k] + 1]++] = members[i];
    });
  }
};

class Grower {
 public:
  Grower(std::span<const Triangle> triangles, std::span<const std::uint32_t> members, std::size_t vertex_count,
         std::uint32_t max_triangles, TriangleGroups& groups)
      : triangles_(triangles),
        members_(members),
        max_triangles_(max_triangles),
        groups_(groups),
        incidences_(triangles, members, vertex_count),
        is_met_(vertex_count, false) {}

  void run() {
    for (const std::uint32_t t : members_) groups_.group_of[t] = no_id;
    for (const std::uint32_t t : members_) {
      if (groups_.group_of[t] != no_id) continue;
      add(t);
      while (!waiting_.empty()) {
        make_room();
        const VertexId v = waiting_.front();
        waiting_.pop_front();
        for (std::uint32_t i = incidences_.first[v]; i < incidences_.first[v + 1]; ++i)
          if (groups_.group_of[incidences_.triangle[i]] == no_id) add(incidences_.triangle[i]);
      }
    }
    ++groups_.count;
  }

 private:
  // Vertices that still wait when a group is full begin the next one.
  void add(std::uint32_t t) {
    if (size_ == max_triangles_) {
      ++groups_.count;
      size_ = 0;
    }
    ++size_;
    groups_.group_of[t] = groups_.count;
    for (int k = 0; k < 3; ++k)
      if (const VertexId v = triangles_[t][k]; !is_met_[v]) {
        is_met_[v] = true;
        waiting_.push_back(v);
      }
  }

  std::span<const Triangle> triangles_;
  std::span<const std::uint32_t> members_;
  std::uint32_t max_triangles_;
  TriangleGroups& groups_;
  Incidences incidences_;
  std::vector<bool> is_met_;
  std::deque<VertexId> waiting_;
  std::uint32_t size_ = 0;  // of the group that grows
};

void number_along(std::span<const std::uint32_t> order, TriangleGroups& groups) {
  std::vector<std::uint32_t> new_number(groups.count, no_id);
  groups.count = 0;
  for_each_id(order.size(), 1, [&](std::uint32_t i) {
    std::uint32_t& group = groups.group_of[order[i]];
    if (new_number[group] == no_id) new_number[group] = groups.count++;
    group = new_number[group];
  });
}

}  // namespace

void grow_stuck_groups(std::span<const Triangle> triangles, std::span<const std::uint32_t> order,
                       std::size_t vertex_count, std::uint32_t max_triangles, TriangleGroups& groups,
                       unsigned threads) {
  if (groups.count == 1) return;
  const std::vector<bool> stuck = find_stuck(triangles, vertex_count, groups, threads);
  LargeVector<std::uint32_t> members;
  for_each_id(order.size(), 1, [&](std::uint32_t i) {
    if (stuck[groups.group_of[order[i]]]) members.push_back(order[i]);
  });
  if (4 * members.size() < triangles.size()) return;
  Grower(triangles, members, vertex_count, max_triangles, groups).run();
  number_along(order, groups);
}

namespace {

constexpr int max_moves = 20;  // per node, because soups may consist of slivers

using Group = std::uint32_t;

struct PatchSize {
  Group group = 0;
  std::uint32_t triangles = 0;
};

// Tracks how many triangles of one node are in which group.
class NodePatches {
 public:
  NodePatches(std::span<const Triangle> triangles, std::span<const Group> group_of)
      : triangles_(triangles), group_of_(group_of.begin(), group_of.end()) {
    std::vector<Group> sorted = group_of_;
    std::sort(sorted.begin(), sorted.end());
    for (const Group group : sorted) {
      if (sizes_.empty() || sizes_.back().group != group) sizes_.push_back({group, 0});
      ++sizes_.back().triangles;
    }
  }

  // Returns whether any patch has moved.
  bool move(std::uint32_t min_triangles) {
    int moves = 0;
    for (; moves < max_moves && sizes_.size() > 1; ++moves) {
      const auto sliver = std::min_element(sizes_.begin(), sizes_.end(), [](const PatchSize& a, const PatchSize& b) {
        return a.triangles < b.triangles;
      });
      if (sliver->triangles >= min_triangles) break;
      const PatchSize gone = *sliver;
      sizes_.erase(sliver);
      const std::size_t to = neighbour_of(gone.group);
      sizes_[to].triangles += gone.triangles;
      std::replace(group_of_.begin(), group_of_.end(), gone.group, sizes_[to].group);
    }
    return moves > 0;
  }

  [[nodiscard]] std::span<const Group> group_of() const { return group_of_; }

 private:
  // Returns the place in sizes_ of the group that shares most corners with `group`; the largest group where none does.
  [[nodiscard]] std::size_t neighbour_of(Group group) const {
    std::vector<VertexId> corners;
    for (std::size_t i = 0; i < triangles_.size(); ++i)
      if (group_of_[i] == group) corners.insert(corners.end(), {triangles_[i].x, triangles_[i].y, triangles_[i].z});
    std::sort(corners.begin(), corners.end());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> rank(sizes_.size());  // shared corners, then triangles
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (group_of_[i] == group) continue;
      const auto at = std::partition_point(sizes_.begin(), sizes_.end(),
                                           [&](const PatchSize& size) { return size.group < group_of_[i]; });
      for (int k = 0; k < 3; ++k)
        if (std::binary_search(corners.begin(), corners.end(), triangles_[i][k]))
          ++rank[static_cast<std::size_t>(at - sizes_.begin())].first;
    }
    for (std::size_t i = 0; i < rank.size(); ++i) rank[i].second = sizes_[i].triangles;
    return static_cast<std::size_t>(std::max_element(rank.begin(), rank.end()) - rank.begin());
  }

  std::span<const Triangle> triangles_;
  std::vector<Group> group_of_;
  std::vector<PatchSize> sizes_;  // per group
};

void drop_empty_groups(std::span<const std::uint32_t> size, TriangleGroups& groups) {
  std::vector<Group> new_number(size.size());
  groups.count = 0;
  for (std::size_t group = 0; group < size.size(); ++group)
    new_number[group] = size[group] > 0 ? groups.count++ : no_id;
  for_each_id(groups.group_of.size(), 1, [&](std::uint32_t t) { groups.group_of[t] = new_number[groups.group_of[t]]; });
}

}  // namespace

void move_slivers(const LevelDraft& level, const Reduction& reduction, TriangleGroups& groups, unsigned threads) {
  LargeVector<Group> moved(groups.group_of.size());  // new groups of all triangles of nodes with slivers
  std::vector<char> has_moved(level.nodes.size(), 0);
  for_each_task(
      level.nodes.size(), threads, [] { return 0; },
      [&](int, std::size_t n) {
        const NodeDraft& node = level.nodes[n];
        NodePatches patches(level.triangles_of(node),
                            std::span(groups.group_of).subspan(node.first_triangle, node.triangle_count));
        if (!patches.move(reduction.smallest_patch)) return;
        has_moved[n] = 1;
        std::ranges::copy(patches.group_of(), moved.begin() + node.first_triangle);
      },
      [] {});
  std::vector<std::uint32_t> size(groups.count, 0);
  for_each_id(groups.group_of.size(), 1, [&](std::uint32_t t) { ++size[groups.group_of[t]]; });
  const std::uint32_t most = reduction.largest_group;
  bool any = false;
  for (std::size_t n = 0; n < has_moved.size(); ++n) {
    make_room();
    if (has_moved[n] == 0) continue;
    const NodeDraft& node = level.nodes[n];
    Group* const before = groups.group_of.data() + node.first_triangle;
    const Group* const after = moved.data() + node.first_triangle;
    bool fits = true;
    for (std::size_t i = 0; i < node.triangle_count; ++i) {
      --size[before[i]];
      fits = ++size[after[i]] <= most && fits;
    }
    if (fits) {
      std::copy_n(after, node.triangle_count, before);
      any = true;
    } else {  // moves back
      for (std::size_t i = 0; i < node.triangle_count; ++i) --size[after[i]], ++size[before[i]];
    }
  }
  if (any) drop_empty_groups(size, groups);
}

}  // namespace occlod::hlod
