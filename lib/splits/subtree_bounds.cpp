#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/memory.h"
#include "base/platform.h"
#include "base/threads.h"
#include "splits/build_steps.h"
#include "splits/packed_bounds.h"
#include "splits/star_patch.h"

namespace occlod {
namespace {

glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
  const float length = glm::length(v);
  return length > 1e-6F && std::isfinite(length) ? v / length : otherwise;
}

// Works in depth-first order, where subtrees are runs: that of the split at place p is places [p, p + size).
class SubtreeBounds {
 public:
  SubtreeBounds(Assembly assembly, unsigned threads)
      : assembly_(std::move(assembly)), threads_(threads), splits_(static_cast<SplitId>(assembly_.parents.size())) {}

  HierarchyData run() {
    order_depth_first();
    place_patches();
    join_boxes();
    join_patches(rows_, blocks_);
    join_patches(blocks_, large_blocks_);
    data().nodes.resize(std::size_t{splits_} + 1);
    for_each_id(splits_ + 1, threads_, [&](SplitId s) { start_node(s); });
    for_each_range(splits_, threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t place = begin; place < end; place += NodeExtents::capacity)
        bound_nodes(place, std::min(place + NodeExtents::capacity, end));
    });
    return std::move(assembly_.data);
  }

 private:
  static constexpr std::size_t block_size = 64;

  // Bounds the own faces of a split, and later its whole subtree.
  struct Region {
    Box box;
    glm::vec3 normal{0.0F};        // sum of unit normals
    std::uint32_t parent = no_id;  // place of the parent in the forest
    SplitId split = no_id;
    std::uint32_t size = 0;  // number of splits in the subtree
  };

  [[nodiscard]] HierarchyData& data() noexcept { return assembly_.data; }

  void order_depth_first() {
    sizes_.assign(splits_, 1);
    for (SplitId s = splits_; s-- > 0;)
      if (const SplitId parent = assembly_.parents[s]; parent != no_id) sizes_[parent] += sizes_[s];
    place_.resize(splits_);
    std::uint32_t next_root = 0;
    for (SplitId s = 0; s < splits_; ++s) {
      const SplitId parent = assembly_.parents[s];
      if (parent == no_id) {
        place_[s] = next_root;
        next_root += sizes_[s];
        continue;
      }
      const SplitId sibling = assembly_.children_u[parent];
      place_[s] = place_[parent] + 1 + (sibling == s || sibling == no_id ? 0 : sizes_[sibling]);
    }
  }

  template <typename Visit>
  void for_each_split(const Visit& visit) const {
    for_each_id(splits_, threads_, visit);
  }

  void place_patches() {
    UninitializedVector<SplitId> split_at(splits_);
    for_each_split([&](SplitId s) { split_at[place_[s]] = s; });
    regions_.resize(splits_);
    rows_ = PatchRows(splits_);
    for_each_id(splits_, threads_, [&](std::uint32_t place) {
      constexpr std::uint32_t ahead = 12;
      if (place + ahead < splits_) {
        const SplitId next = split_at[place + ahead];
        prefetch(&assembly_.patches[next]);
        prefetch(&sizes_[next]);
        prefetch(&assembly_.parents[next]);
      }
      const SplitId s = split_at[place], parent = assembly_.parents[s];
      const BoundedPatch& own = assembly_.patches[s];
      rows_.set(place, own.patch);
      regions_[place] = {own.box, own.patch.has_normal ? own.patch.axis : glm::vec3(0.0F),
                         parent == no_id ? no_id : place_[parent], s, sizes_[s]};
    });
    UninitializedVector<BoundedPatch>().swap(assembly_.patches);
  }

  // Extends bounds from own faces to subtrees: descendants of a split follow it in the order.
  void join_boxes() {
    for (std::size_t p = splits_; p-- > 0;) {
      const Region& region = regions_[p];
      if (region.parent == no_id) continue;
      Region& above = regions_[region.parent];
      above.box.min = glm::min(above.box.min, region.box.min);
      above.box.max = glm::max(above.box.max, region.box.max);
      above.normal += region.normal;
    }
  }

  // Merges each run of block_size patches into one.
  void join_patches(const PatchRows& patches, PatchRows& blocks) const {
    blocks = PatchRows((patches.size() + block_size - 1) / block_size);
    for_each_id(blocks.size(), threads_, [&](std::uint32_t block) {
      const std::size_t first = block * block_size;
      blocks.set(block, join_patches(patches, first, std::min(first + block_size, patches.size())));
    });
  }

  static Patch join_patches(const PatchRows& patches, std::size_t first, std::size_t end) {
    Patch block;
    glm::vec3 normal(0.0F);
    glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
    for (std::size_t i = first; i < end; ++i) {
      const Patch patch = patches[i];
      if (patch.has_normal) normal += patch.axis;
      low = glm::min(low, patch.sphere.center - patch.sphere.radius);
      high = glm::max(high, patch.sphere.center + patch.sphere.radius);
    }
    block.axis = unit_or(normal, glm::vec3(0, 0, 1));
    block.sphere.center = 0.5F * low + 0.5F * high;
    for (std::size_t i = first; i < end; ++i) {
      const Patch patch = patches[i];
      block.sphere.radius =
          std::max(block.sphere.radius, length_of(patch.sphere.center - block.sphere.center) + patch.sphere.radius);
      if (!patch.has_normal) continue;
      block.cos_angle = std::min(block.cos_angle, widened(block.axis, patch));
      block.has_normal = true;
    }
    block.sphere.radius = block.sphere.radius * grow + denormal_slack;
    if (block.cos_angle <= 0.0F) block.cos_angle = -1.0F;
    block.sin_angle = std::sqrt(std::max(0.0F, (1.0F - block.cos_angle) * (1.0F + block.cos_angle)));
    return block;
  }

  // Calls visit(rows, first, end) for patches that together cover places [first, end): single patches at the ends,
  // blocks in between.
  template <typename Visit>
  void for_each_run(std::size_t first, std::size_t end, const Visit& visit) const {
    const auto up = [](std::size_t place) { return (place + block_size - 1) / block_size; };
    const std::size_t first_block = up(first), end_block = end / block_size;
    if (first_block >= end_block) return visit(rows_, first, end);
    visit(rows_, first, first_block * block_size);
    visit(rows_, end_block * block_size, end);
    const std::size_t first_large = up(first_block), end_large = end_block / block_size;
    if (first_large >= end_large) return visit(blocks_, first_block, end_block);
    visit(blocks_, first_block, first_large * block_size);
    visit(blocks_, end_large * block_size, end_block);
    visit(large_blocks_, first_large, end_large);
  }

  // Returns the largest distance from `center` to a point of the box.
  static float reach(const glm::vec3& center, const Box& box) {
    return length_of(glm::max(box.max - center, center - box.min)) * grow + denormal_slack;
  }

  // Sets all fields of a node except its bounds; of the sentinel behind the last node, only the star.
  void start_node(SplitId s) {
    SplitNode& node = data().nodes[s] = {};
    node.star = assembly_.stars[s];
    if (s == splits_) return;
    node.error = assembly_.errors[s].quadric;
    node.guaranteed_error = assembly_.errors[s].guaranteed;
    node.child_u = assembly_.children_u[s];
    node.child_v = assembly_.children_v[s];
    node.parent = assembly_.parents[s];
  }

  // In depth-first order patches are in the cache, but nodes are scattered in memory.
  void bound_nodes(std::size_t first, std::size_t end) {
    NodeExtents nodes;
    nodes.size.fill(0);
    for (std::size_t place = first; place < end; ++place) {
      prefetch(&data().nodes[regions_[place].split]);
      start_bounds(nodes, place - first, regions_[place]);
    }
    include_patches(rows_, first, nodes);
    for (std::size_t place = first; place < end; ++place) {
      const std::size_t i = place - first;
      const std::size_t node_end = place + regions_[place].size;
      if (nodes.size[i] == 0)
        for_each_run(place, node_end, [&](const PatchRows& patches, std::size_t begin, std::size_t run_end) {
          if (begin < run_end) include_run(patches, begin, run_end, nodes, i);
        });
      if (nodes.is_extreme[i] != 0) measure_exactly(nodes, i, place);
      bound(data().nodes[regions_[place].split], nodes, i, regions_[place].box);
    }
  }

  // Centres all bounds on the middle of the box. The paper uses the normal of the split vertex as the axis; we use the
  // mean normal of the subtree, which is that of its surface at every level.
  void start_bounds(NodeExtents& nodes, std::size_t i, const Region& region) {
    PackedBounds bounds;
    bounds.set_axis(unit_or(region.normal, glm::vec3(0, 0, 1)));
    set_packed_bounds(data().nodes[region.split], bounds);
    nodes.start(i, center_of(region.box), bounds.unpack_axis());
    if (region.size < NodeExtents::capacity) nodes.size[i] = static_cast<std::int32_t>(region.size);
  }

  static glm::vec3 center_of(const Box& box) { return 0.5F * box.min + 0.5F * box.max; }

  // Measures the extents of the node at `place` where squared lengths leave the range of floats.
  void measure_exactly(NodeExtents& nodes, std::size_t i, std::size_t place) const {
    const glm::vec3 center(nodes.center_x[i], nodes.center_y[i], nodes.center_z[i]);
    const glm::vec3 axis(nodes.axis_x[i], nodes.axis_y[i], nodes.axis_z[i]);
    nodes.radius[i] = nodes.cylinder_radius[i] = 0.0F;
    const auto include = [&](const Patch& patch) {
      const glm::vec3 offset = patch.sphere.center - center;
      const glm::vec3 beside = offset - glm::dot(offset, axis) * axis;
      nodes.radius[i] = std::max(nodes.radius[i], length_of(offset) + patch.sphere.radius);
      nodes.cylinder_radius[i] = std::max(nodes.cylinder_radius[i], length_of(beside) + patch.sphere.radius);
    };
    for_each_run(place, place + regions_[place].size,
                 [&](const PatchRows& patches, std::size_t first, std::size_t end) {
                   for (std::size_t p = first; p < end; ++p) include(patches[p]);
                 });
  }

  static void bound(SplitNode& node, const NodeExtents& nodes, std::size_t i, const Box& box) {
    const glm::vec3 center = center_of(box);
    const float radius = nodes.radius[i];
    const float slack = radius * (grow - 1.0F) + denormal_slack;
    // A sphere around the box is a valid bound as well.
    node.sphere = {center, std::min(radius + slack, reach(center, box))};
    const Cylinder cylinder{center, std::min(nodes.cylinder_radius[i] + slack, node.sphere.radius), glm::vec3(0.0F),
                            std::max(nodes.t_min[i] - slack, -node.sphere.radius),
                            std::min(nodes.t_max[i] + slack, node.sphere.radius)};
    PackedBounds bounds = packed_bounds(node);
    bounds.set_cone(nodes.has_normal[i] != 0 ? nodes.cos_angle[i] : -1.0F);
    bounds.set_cylinder(node.sphere, cylinder);
    bounds.set_box(node.sphere, box);
    set_packed_bounds(node, bounds);
  }

  Assembly assembly_;
  unsigned threads_;
  SplitId splits_;
  UninitializedVector<std::uint32_t> place_;  // per split
  LargeVector<std::uint32_t> sizes_;          // per split: size of its subtree
  // The rows of patches, by place, and of blocks of them.
  PatchRows rows_{0}, blocks_{0}, large_blocks_{0};
  UninitializedVector<Region> regions_;
};

}  // namespace

HierarchyData bound_subtrees(Assembly assembly, unsigned threads) {
  return SubtreeBounds(std::move(assembly), threads).run();
}

}  // namespace occlod
