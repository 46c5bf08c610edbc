#include "support/renumber.h"

#include <algorithm>
#include <numeric>
#include <random>

#include "splits/hierarchy_data.h"
#include "splits/star.h"
#include "splits/star_record.h"

namespace occlod::bench {
namespace {

class Renumbering {
 public:
  Renumbering(const Hierarchy& hierarchy, std::span<const SplitId> order)
      : hierarchy_(hierarchy), order_(order), new_id_(order.size()) {
    for (std::size_t i = 0; i < order.size(); ++i) new_id_[order[i]] = static_cast<SplitId>(i);
  }

  HierarchyData run() {
    const HierarchyView& old = hierarchy_.data();
    HierarchyData data = copy_data(hierarchy_);
    permute(old.positions, data.positions);
    permute(old.normals, data.normals);
    permute(old.colors, data.colors);
    std::vector<std::uint32_t> stars;
    for (std::size_t i = 0; i < order_.size(); ++i) {
      SplitNode node = hierarchy_.node(order_[i]);
      for (SplitId* link : {&node.child_u, &node.child_v, &node.parent}) *link = split(*link);
      node.star = static_cast<std::uint32_t>(stars.size());
      data.nodes[i] = node;
      append(star_of(hierarchy_, order_[i]), stars);
    }
    data.stars.assign(stars.begin(), stars.end());
    std::transform(old.roots.begin(), old.roots.end(), data.roots.begin(), [&](SplitId s) { return split(s); });
    std::sort(data.roots.begin(), data.roots.end());
    return data;
  }

 private:
  [[nodiscard]] SplitId split(SplitId s) const { return s == no_id ? no_id : new_id_[s]; }
  [[nodiscard]] VertexId vertex(VertexId v) const {
    const std::size_t base = hierarchy_.base_vertex_count();
    return v < base ? v : static_cast<VertexId>(base + new_id_[v - base]);
  }
  [[nodiscard]] Triangle triangle(const Triangle& t) const { return {vertex(t.x), vertex(t.y), vertex(t.z)}; }

  template <typename T>
  void permute(std::span<const T> from, UninitializedVector<T>& to) const {
    for (VertexId v = 0; v < from.size(); ++v) to[vertex(v)] = from[v];
  }

  void append(const SplitStar& star, std::vector<std::uint32_t>& words) {
    std::vector<Triangle> inserted;
    std::vector<RemovedFace> removed;
    std::vector<SplitId> dependencies;
    star.for_each_inserted([&](const Triangle& t) { inserted.push_back(triangle(t)); });
    star.for_each_removed([&](const FaceRef& f, const Triangle& t) {
      removed.push_back({{split(f.split), f.slot}, triangle(t)});
    });
    for (const SplitId s : star.dependencies()) dependencies.push_back(split(s));
    std::sort(dependencies.begin(), dependencies.end());
    const StarShape fan = star.ring().size() == inserted.size() ? StarShape::closed_fan : StarShape::open_fan;
    append_star({vertex(star.parent_vertex()), star.is_fan() ? fan : StarShape::other, inserted, removed, dependencies},
                words);
  }

  const Hierarchy& hierarchy_;
  std::span<const SplitId> order_;
  std::vector<SplitId> new_id_;
};

}  // namespace

Hierarchy renumbered(const Hierarchy& hierarchy, std::span<const SplitId> order) {
  return make_hierarchy(Renumbering(hierarchy, order).run());
}

std::vector<SplitId> shuffled_levels(const Hierarchy& hierarchy, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  struct Key {
    std::uint32_t level;
    std::uint64_t ticket;
  };
  std::vector<Key> keys;
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    std::uint32_t level = 0;
    if (const SplitId parent = hierarchy.node(s).parent; parent != no_id) level = keys[parent].level + 1;
    for (const SplitId needed : star_of(hierarchy, s).dependencies()) level = std::max(level, keys[needed].level + 1);
    keys.push_back({level, random()});
  }
  std::vector<SplitId> order(keys.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](SplitId a, SplitId b) {
    return keys[a].level != keys[b].level ? keys[a].level < keys[b].level : keys[a].ticket < keys[b].ticket;
  });
  return order;
}

}  // namespace occlod::bench
