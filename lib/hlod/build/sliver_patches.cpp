#include "hlod/build/sliver_patches.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "splits/parallel.h"

namespace occlod::hlod {
namespace {

constexpr std::uint32_t smallest_share = 32;  // of node_triangles
constexpr int most_moves = 20;                // of one node: soups may consist of slivers
// Of node_triangles. A group of so many triangles has at most three times as many vertices, which 16 bits can number.
constexpr std::uint32_t largest_group = 5;

using Group = std::uint32_t;

struct PatchSize {
  Group group = 0;
  std::uint32_t triangles = 0;
};

// What one node has in which group, and how that changes.
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

  // Whether anything has moved.
  bool move(std::uint32_t least_triangles) {
    int moves = 0;
    for (; moves < most_moves && sizes_.size() > 1; ++moves) {
      const auto sliver = std::min_element(sizes_.begin(), sizes_.end(), [](const PatchSize& a, const PatchSize& b) {
        return a.triangles < b.triangles;
      });
      if (sliver->triangles >= least_triangles) break;
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
  // The place in sizes_ of the group that shares most corners with it; the largest where none does.
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
  std::vector<PatchSize> sizes_;  // by group
};

void drop_empty_groups(std::span<const std::uint32_t> size, TriangleGroups& groups) {
  std::vector<Group> new_number(size.size());
  groups.count = 0;
  for (std::size_t group = 0; group < size.size(); ++group)
    new_number[group] = size[group] > 0 ? groups.count++ : no_id;
  for_each_id(groups.group_of.size(), 1, [&](std::uint32_t t) { groups.group_of[t] = new_number[groups.group_of[t]]; });
}

}  // namespace

void move_slivers(const LevelDraft& level, std::uint32_t node_triangles, TriangleGroups& groups, unsigned threads) {
  LargeVector<Group> moved(groups.group_of.size());  // groups of all triangles of those with slivers
  std::vector<char> has_moved(level.nodes.size(), 0);
  for_each_task(
      level.nodes.size(), threads, [] { return 0; },
      [&](int, std::size_t n) {
        const NodeDraft& node = level.nodes[n];
        NodePatches patches(level.triangles_of(node),
                            std::span(groups.group_of).subspan(node.first_triangle, node.triangle_count));
        if (!patches.move(node_triangles / smallest_share)) return;
        has_moved[n] = 1;
        std::ranges::copy(patches.group_of(), moved.begin() + node.first_triangle);
      },
      [] {});
  std::vector<std::uint32_t> size(groups.count, 0);
  for_each_id(groups.group_of.size(), 1, [&](std::uint32_t t) { ++size[groups.group_of[t]]; });
  const std::uint32_t most = largest_group * node_triangles;
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
    } else {  // back
      for (std::size_t i = 0; i < node.triangle_count; ++i) --size[after[i]], ++size[before[i]];
    }
  }
  if (any) drop_empty_groups(size, groups);
}

}  // namespace occlod::hlod
