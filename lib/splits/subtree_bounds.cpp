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
#include "splits/star_points.h"

namespace occlod {
namespace {

// Keeps bounds conservative under rounding: differences of single-precision positions are correct to half a unit in the
// last place, and no sum has more than a dozen terms.
constexpr float grow = 1.0F + 4e-6F;
// Rounding error of numbers so small that their last place no longer shrinks with them: some twenty units of it.
constexpr float denormal_slack = 3e-44F;

// Returns the length, also for vectors whose squares overflow or underflow a float.
float length_of(const glm::vec3& v) {
  const float square = glm::dot(v, v);
  return square > 1e-30F && square < 1e30F ? std::sqrt(square) : static_cast<float>(glm::length(glm::dvec3(v)));
}

glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
  const float length = glm::length(v);
  return length > 1e-6F && std::isfinite(length) ? v / length : otherwise;
}

// Works in depth-first order, where subtrees are runs: that of the split at place p is places [p, p + size).
class SubtreeBounds {
 public:
  SubtreeBounds(Assembly assembly, unsigned threads)
      : assembly_(std::move(assembly)),
        threads_(threads),
        splits_(static_cast<SplitId>(assembly_.parents.size())),
        base_vertices_(static_cast<VertexId>(data().positions.size() - data().extra_wedges.size() - splits_)) {}

  HierarchyData run() {
    order_depth_first();
    place_patches();
    join_boxes();
    join_patches(rows_, blocks_);
    join_patches(blocks_, large_blocks_);
    data().nodes.resize(std::size_t{splits_} + 1);
    for_each_id(splits_ + 1, threads_, [&](SplitId s) { start_node(s); });
    for_each_task((splits_ + range_size - 1) / range_size, threads_, [] { return StarPoints(); },
                  [&](StarPoints& points, std::size_t range) {
                    bound_range(points, range * range_size, std::min<std::size_t>((range + 1) * range_size, splits_));
                  },
                  [] {});
    bound_large_nodes();
    return std::move(assembly_.data);
  }

 private:
  static constexpr std::size_t block_size = 64;
  static constexpr std::uint32_t max_small = 4096;  // number of splits of a small subtree
  static constexpr int joined_levels = 6;           // bounds of a large subtree are joined from those so far below it

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
    for (std::size_t i = first; i < end; ++i)
      if (const Patch patch = patches[i]; patch.has_normal) normal += patch.axis;
    block.axis = unit_or(normal, glm::vec3(0, 0, 1));
    for (std::size_t i = first; i < end; ++i) {
      const Patch patch = patches[i];
      if (!patch.has_normal) continue;
      block.cos_angle = std::min(block.cos_angle, widened(block.axis, patch));
      block.has_normal = true;
    }
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

  // True for subtrees whose bounds are fitted to all corners of their stars.
  [[nodiscard]] bool is_small(std::size_t place) const { return regions_[place].size <= max_small; }

  // Returns the end of the small subtree that holds both `place` and the place before it; `place` when there is none.
  [[nodiscard]] std::size_t after_small_subtree(std::size_t place) const {
    if (place == splits_) return place;
    std::size_t root = place;
    while (regions_[root].parent != no_id && is_small(regions_[root].parent)) root = regions_[root].parent;
    return root < place ? root + regions_[root].size : place;
  }

  // Bounds the nodes of whole small subtrees in or at the end of places [begin, end), and the cones of the others.
  void bound_range(StarPoints& points, std::size_t begin, std::size_t end) {
    begin = after_small_subtree(begin);
    end = after_small_subtree(end);
    points.clear();
    for (std::size_t place = begin; place < end; ++place) {
      if (place % steps_for_room == 0) make_room();
      prefetch_star(place, end);
      points.add(star_at(place), data().positions);
    }
    for (std::size_t place = begin; place < end; place += NodeExtents::capacity)
      bound_nodes(points, begin, place, std::min(place + NodeExtents::capacity, end));
  }

  [[nodiscard]] SplitStar star_at(std::size_t place) const {
    const SplitId s = regions_[place].split;
    return {assembly_.data.stars.data() + assembly_.stars[s], base_vertices_ + s};
  }

  // Stars in depth-first order are scattered in memory, and so are their corners.
  void prefetch_star(std::size_t place, std::size_t end) const {
    constexpr std::size_t ahead = 8;
    if (place + 3 * ahead < end) prefetch(&assembly_.stars[regions_[place + 3 * ahead].split]);
    if (place + 2 * ahead < end)
      prefetch(assembly_.data.stars.data() + assembly_.stars[regions_[place + 2 * ahead].split]);
    if (place + ahead >= end) return;
    const SplitStar star = star_at(place + ahead);
    if (star.is_fan())
      for (const VertexId v : star.ring()) prefetch(&assembly_.data.positions[v]);
  }

  // `points` holds the stars from place first_point. In depth-first order patches are in the cache, but nodes are
  // scattered in memory.
  void bound_nodes(const StarPoints& points, std::size_t first_point, std::size_t first, std::size_t end) {
    NodeExtents nodes;
    nodes.size.fill(0);
    for (std::size_t place = end; place < std::min<std::size_t>(end + NodeExtents::capacity, splits_); ++place)
      prefetch(&data().nodes[regions_[place].split]);
    for (std::size_t place = first; place < end; ++place) start_bounds(nodes, place - first, regions_[place]);
    include_patches(rows_, first, nodes);
    for (std::size_t place = first; place < end; ++place) {
      const std::size_t i = place - first;
      const std::size_t node_end = place + regions_[place].size;
      if (nodes.size[i] == 0)
        for_each_run(place, node_end, [&](const PatchRows& patches, std::size_t begin, std::size_t run_end) {
          if (begin < run_end) include_run(patches, begin, run_end, nodes, i);
        });
      SplitNode& node = data().nodes[regions_[place].split];
      PackedBounds bounds = packed_bounds(node);
      bounds.set_cone(nodes.has_normal[i] != 0 ? nodes.cos_angle[i] : -1.0F);
      set_packed_bounds(node, bounds);
      if (!is_small(place)) continue;
      const glm::vec3 axis(nodes.axis_x[i], nodes.axis_y[i], nodes.axis_z[i]);
      bound(node, regions_[place].box,
            points.extents(place - first_point, node_end - first_point, center_of(regions_[place].box), axis));
    }
  }

  // Birkholz & Rahn, sec. 4, use the normal of the split vertex as the axis; we use the mean normal of the subtree,
  // which is that of its surface at every level.
  void start_bounds(NodeExtents& nodes, std::size_t i, const Region& region) {
    PackedBounds bounds;
    bounds.set_axis(unit_or(region.normal, glm::vec3(0, 0, 1)));
    set_packed_bounds(data().nodes[region.split], bounds);
    nodes.start(i, bounds.unpack_axis());
    if (region.size < NodeExtents::capacity) nodes.size[i] = static_cast<std::int32_t>(region.size);
  }

  static glm::vec3 center_of(const Box& box) { return 0.5F * box.min + 0.5F * box.max; }

  // Bounds the nodes of large subtrees, each after those below it.
  void bound_large_nodes() {
    StarPoints points;
    for (std::size_t place = splits_; place-- > 0;) {
      if (is_small(place)) continue;
      const glm::vec3 center = center_of(regions_[place].box);
      SplitNode& node = data().nodes[regions_[place].split];
      const glm::vec3 axis = packed_bounds(node).unpack_axis();
      points.clear();
      points.add(star_at(place), data().positions);
      PointExtents extents = points.extents(0, 1, center, axis);
      include_children(place, joined_levels, points, center, axis, extents);
      bound(node, regions_[place].box, extents);
    }
  }

  // Includes the subtrees below the split at `place`, as the bounds of those some levels further down.
  void include_children(std::size_t place, int levels, StarPoints& points, const glm::vec3& center,
                        const glm::vec3& axis, PointExtents& extents) const {
    const SplitNode& node = assembly_.data.nodes[regions_[place].split];
    for (const SplitId child : {node.child_u, node.child_v}) {
      if (child == no_id) continue;
      const std::size_t below = place_[child];
      if (levels == 0 || is_small(below)) {
        include(assembly_.data.nodes[child], regions_[below].box, center, axis, extents);
        continue;
      }
      points.clear();
      points.add(star_at(below), assembly_.data.positions);
      raise(extents, points.extents(0, 1, center, axis));
      include_children(below, levels - 1, points, center, axis, extents);
    }
  }

  static void raise(PointExtents& extents, const PointExtents& more) {
    extents = {std::max(extents.radius, more.radius), std::max(extents.cylinder_radius, more.cylinder_radius),
               std::min(extents.t_min, more.t_min), std::max(extents.t_max, more.t_max)};
  }

  // Includes what the sphere, the cylinder and the box of a node have in common.
  static void include(const SplitNode& node, const Box& box, const glm::vec3& center, const glm::vec3& axis,
                      PointExtents& extents) {
    const Cylinder cylinder = node.cylinder();
    const glm::dvec3 offset = glm::dvec3(cylinder.center) - glm::dvec3(center), direction(axis), along(cylinder.axis);
    const auto beside = [&](const glm::dvec3& v) { return glm::length(v - glm::dot(v, direction) * direction); };
    const double radius = node.sphere.radius, t = glm::dot(offset, direction), cos = glm::dot(along, direction);
    const double rim = cylinder.radius * glm::length(glm::cross(along, direction));
    const double box_t = glm::dot(0.5 * (glm::dvec3(box.max) - glm::dvec3(box.min)), glm::abs(direction));
    const double low = std::min(cos * cylinder.t_min, cos * cylinder.t_max) - rim;
    const double high = std::max(cos * cylinder.t_min, cos * cylinder.t_max) + rim;
    const double around = cylinder.radius + std::max(beside(offset + double{cylinder.t_min} * along),
                                                     beside(offset + double{cylinder.t_max} * along));
    raise(extents, {static_cast<float>(glm::length(offset) + radius),
                    static_cast<float>(std::min(beside(offset) + radius, around)),
                    static_cast<float>(t + std::max({low, -radius, -box_t})),
                    static_cast<float>(t + std::min({high, radius, box_t}))});
  }

  // Centres all bounds on the middle of the box.
  static void bound(SplitNode& node, const Box& box, const PointExtents& extents) {
    const glm::vec3 center = center_of(box);
    const float slack = extents.radius * (grow - 1.0F) + denormal_slack;
    // A sphere around the box is a valid bound as well.
    node.sphere = {center, std::min(extents.radius + slack, reach(center, box))};
    const Cylinder cylinder{center, std::min(extents.cylinder_radius + slack, node.sphere.radius), glm::vec3(0.0F),
                            std::max(extents.t_min - slack, -node.sphere.radius),
                            std::min(extents.t_max + slack, node.sphere.radius)};
    PackedBounds bounds = packed_bounds(node);
    bounds.set_cylinder(node.sphere, cylinder);
    bounds.set_box(node.sphere, box);
    set_packed_bounds(node, bounds);
  }

  Assembly assembly_;
  unsigned threads_;
  SplitId splits_;
  VertexId base_vertices_;
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
