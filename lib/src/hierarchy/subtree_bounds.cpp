#include "subtree_bounds.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "core/large_vector.h"
#include "core/platform.h"
#include "parallel.h"
#include "star_patch.h"

namespace occlod {
namespace {

// Extends a cone around `axis` so that it holds the patch's cone; -1 once it holds a half space or more.
float widen(float cos_angle, const glm::vec3& axis, const Patch& patch) {
  if (!patch.has_normal || cos_angle <= 0.0F) return cos_angle;
  const float cos_between = glm::dot(axis, patch.axis);
  if (cos_between <= 0.0F || patch.cos_angle <= 0.0F) return -1.0F;
  // From the cross product: the root of 1 - cos^2 is all rounding error for small angles.
  const float sin_between = glm::length(glm::cross(axis, patch.axis));
  return std::min(cos_angle, cos_between * patch.cos_angle - sin_between * patch.sin_angle - cone_slack);
}

glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
  const float length = glm::length(v);
  return length > 1e-6F && std::isfinite(length) ? v / length : otherwise;
}

// Works in depth-first order: subtrees become runs, that of the split at place p is places [p, p + size).
class SubtreeBounds {
 public:
  SubtreeBounds(Assembly assembly, unsigned threads)
      : assembly_(std::move(assembly)), threads_(threads), splits_(static_cast<SplitId>(assembly_.parents.size())) {}

  HierarchyData run() {
    order_depth_first();
    bound_stars();
    join_boxes();
    join_patches(patches_, blocks_);
    join_patches(blocks_, large_blocks_);
    data().nodes.resize(std::size_t{splits_} + 1);
    for_each_split([&](SplitId s) { make_node(s); });
    data().nodes.back().star = assembly_.stars.back();
    return std::move(assembly_.data);
  }

 private:
  static constexpr std::size_t block_size = 64;

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

  void bound_stars() {
    patches_.resize(splits_);
    regions_.resize(splits_);
    const auto base_vertices = static_cast<VertexId>(data().positions.size() - splits_);
    for_each_split([&](SplitId s) {
      // Ring vertices are anywhere in memory.
      if (s + 4 < splits_) {
        const SplitStar next(data().stars.data() + assembly_.stars[s + 4], base_vertices + s + 4);
        for (const VertexId w : next.ring()) prefetch(&data().positions[w]);
        prefetch(&patches_[place_[s + 4]]);
        prefetch(&regions_[place_[s + 4]]);
      }
      const SplitStar star(data().stars.data() + assembly_.stars[s], base_vertices + s);
      const BoundedPatch own = bound_star(star, data().positions);
      const SplitId parent = assembly_.parents[s];
      patches_[place_[s]] = own.patch;
      regions_[place_[s]] = {own.box, own.patch.has_normal ? own.patch.axis : glm::vec3(0.0F),
                             parent == no_id ? no_id : place_[parent]};
    });
  }

  // From own faces to subtrees: below a split means behind it in the order.
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

  // One patch for each block_size patches in a row.
  static void join_patches(const LargeVector<Patch>& patches, LargeVector<Patch>& blocks) {
    for (std::size_t first = 0; first < patches.size(); first += block_size) {
      const std::size_t end = std::min(first + block_size, patches.size());
      Patch block;
      glm::vec3 normal(0.0F);
      glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
      for (std::size_t i = first; i < end; ++i) {
        if (patches[i].has_normal) normal += patches[i].axis;
        low = glm::min(low, patches[i].sphere.center - patches[i].sphere.radius);
        high = glm::max(high, patches[i].sphere.center + patches[i].sphere.radius);
      }
      block.axis = unit_or(normal, glm::vec3(0, 0, 1));
      block.sphere.center = 0.5F * low + 0.5F * high;
      for (std::size_t i = first; i < end; ++i) {
        const Sphere& sphere = patches[i].sphere;
        block.sphere.radius =
            std::max(block.sphere.radius, length_of(sphere.center - block.sphere.center) + sphere.radius);
        block.cos_angle = widen(block.cos_angle, block.axis, patches[i]);
        block.has_normal = block.has_normal || patches[i].has_normal;
      }
      block.sphere.radius = block.sphere.radius * grow + denormal_slack;
      if (block.cos_angle <= 0.0F) block.cos_angle = -1.0F;
      block.sin_angle = std::sqrt(std::max(0.0F, (1.0F - block.cos_angle) * (1.0F + block.cos_angle)));
      blocks.push_back(block);
    }
  }

  // Calls visit for patches that together hold places [first, end): single ones at the ragged ends, blocks between.
  template <typename Visit>
  void for_each_patch(std::size_t first, std::size_t end, const Visit& visit) const {
    constexpr std::size_t large_size = block_size * block_size;
    while (first < end) {
      if (first % large_size == 0 && first + large_size <= end) {
        visit(large_blocks_[first / large_size]);
        first += large_size;
      } else if (first % block_size == 0 && first + block_size <= end) {
        visit(blocks_[first / block_size]);
        first += block_size;
      } else {
        visit(patches_[first++]);
      }
    }
  }

  // The largest distance from `center` to a point of the box.
  static float reach(const glm::vec3& center, const Box& box) {
    return length_of(glm::max(box.max - center, center - box.min)) * grow + denormal_slack;
  }

  void make_node(SplitId s) {
    if (s + 6 < splits_) {
      const Patch* const first = &patches_[place_[s + 6]];
      prefetch(first);
      prefetch(first + 2);
      prefetch(&regions_[place_[s + 6]]);
    }
    SplitNode& node = data().nodes[s];
    node.error = assembly_.errors[s].quadric;
    node.guaranteed_error = assembly_.errors[s].guaranteed;
    node.child_u = assembly_.children_u[s];
    node.child_v = assembly_.children_v[s];
    node.parent = assembly_.parents[s];
    node.star = assembly_.stars[s];
    bound(node, place_[s], sizes_[s]);
  }

  // All bounds are around the middle of the box. The paper's axis is the normal of the split vertex; the mean normal of
  // the subtree is that of its surface at every level.
  void bound(SplitNode& node, std::size_t place, std::size_t size) {
    const Box& box = regions_[place].box;
    const glm::vec3 center = 0.5F * box.min + 0.5F * box.max;
    node.bounds.set_axis(unit_or(regions_[place].normal, glm::vec3(0, 0, 1)));
    const glm::vec3 axis = node.bounds.unpack_axis();
    Cylinder cylinder{center, 0.0F, axis, std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()};
    float radius = 0.0F;
    float cos_angle = 1.0F;
    bool has_normal = false;
    for_each_patch(place, place + size, [&](const Patch& patch) {
      const glm::vec3 offset = patch.sphere.center - center;
      const float along = glm::dot(offset, axis);
      radius = std::max(radius, length_of(offset) + patch.sphere.radius);
      cylinder.radius = std::max(cylinder.radius, length_of(offset - along * axis) + patch.sphere.radius);
      cylinder.t_min = std::min(cylinder.t_min, along - patch.sphere.radius);
      cylinder.t_max = std::max(cylinder.t_max, along + patch.sphere.radius);
      cos_angle = widen(cos_angle, axis, patch);
      has_normal = has_normal || patch.has_normal;
    });
    const float slack = radius * (grow - 1.0F) + denormal_slack;
    // A sphere around the box holds everything as well.
    node.sphere = {center, std::min(radius + slack, reach(center, box))};
    cylinder.radius = std::min(cylinder.radius + slack, node.sphere.radius);
    cylinder.t_min = std::max(cylinder.t_min - slack, -node.sphere.radius);
    cylinder.t_max = std::min(cylinder.t_max + slack, node.sphere.radius);
    node.bounds.set_cone(has_normal ? cos_angle : -1.0F);
    node.bounds.set_cylinder(node.sphere, cylinder);
    node.bounds.set_box(node.sphere, box);
  }

  // What own faces occupy, later whole subtrees.
  struct Region {
    Box box;
    glm::vec3 normal{0.0F};        // sum of unit normals
    std::uint32_t parent = no_id;  // place of the forest parent
  };

  Assembly assembly_;
  unsigned threads_;
  SplitId splits_;
  LargeVector<std::uint32_t> place_;  // of each split
  LargeVector<std::uint32_t> sizes_;  // of each split's subtree
  // By place:
  LargeVector<Patch> patches_;  // of own faces
  LargeVector<Patch> blocks_, large_blocks_;
  LargeVector<Region> regions_;
};

}  // namespace

HierarchyData bound_subtrees(Assembly assembly, unsigned threads) {
  return SubtreeBounds(std::move(assembly), threads).run();
}

}  // namespace occlod
