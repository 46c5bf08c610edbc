#include "hlod/build/grow_groups.h"

#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include "splits/parallel.h"
#include "hlod/build/shared_vertices.h"

namespace occlod::hlod {
namespace {

// By group.
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

// The triangles at each vertex.
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
         std::uint32_t most_triangles, TriangleGroups& groups)
      : triangles_(triangles),
        members_(members),
        most_triangles_(most_triangles),
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
  // Whatever still waits when a group is full begins the next one.
  void add(std::uint32_t t) {
    if (size_ == most_triangles_) {
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
  std::uint32_t most_triangles_;
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
                       std::size_t vertex_count, std::uint32_t most_triangles, TriangleGroups& groups,
                       unsigned threads) {
  if (groups.count == 1) return;
  const std::vector<bool> stuck = find_stuck(triangles, vertex_count, groups, threads);
  LargeVector<std::uint32_t> members;
  for_each_id(order.size(), 1, [&](std::uint32_t i) {
    if (stuck[groups.group_of[order[i]]]) members.push_back(order[i]);
  });
  if (4 * members.size() < triangles.size()) return;
  Grower(triangles, members, vertex_count, most_triangles, groups).run();
  number_along(order, groups);
}

}  // namespace occlod::hlod
