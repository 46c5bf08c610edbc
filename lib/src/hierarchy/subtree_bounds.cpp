#include "subtree_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "parallel.h"

namespace occlod {
namespace {

// Factors that keep bounds outside through the roundings of this file: differences of single-precision positions are
// correct to half a unit in their own last place, and no sum here is longer than a dozen terms.
constexpr float grow = 1.0F + 4e-6F;
constexpr float cone_slack = 4e-6F;

// What one split's own faces, or a run of splits, occupy: a sphere and the cone of their normals.
struct Patch {
  Sphere sphere;
  glm::vec3 axis{0.0F};
  float cos_angle = 1.0F;  // of the half angle; -1 = every direction
  float sin_angle = 0.0F;
  bool has_normal = false;  // false: only faces without area
};

// Extends a cone around `axis` so that it holds the patch's cone; -1 once it holds a half space or more.
float widen(float cos_angle, const glm::vec3& axis, const Patch& patch) {
  if (!patch.has_normal || cos_angle <= 0.0F) return cos_angle;
  const float cos_between = glm::dot(axis, patch.axis);
  if (cos_between <= 0.0F || patch.cos_angle <= 0.0F) return -1.0F;
  // From the cross product: the root of 1 - cos^2 is all rounding error for small angles.
  const float sin_between = glm::length(glm::cross(axis, patch.axis));
  return std::min(cos_angle, cos_between * patch.cos_angle - sin_between * patch.sin_angle - cone_slack);
}

glm::vec3 unit_or(const glm::dvec3& v, const glm::vec3& otherwise) {
  const double length = glm::length(v);
  return length > 0.0 && std::isfinite(length) ? glm::vec3(v / length) : otherwise;
}

class SubtreeBounds {
 public:
  SubtreeBounds(HierarchyData& data, unsigned threads)
      : data_(data), threads_(threads), splits_(data.nodes.size() - 1) {}

  void run() {
    order_depth_first();
    patches_.resize(splits_);
    boxes_of_subtrees();
    join(patches_, blocks_);
    join(blocks_, large_blocks_);
    for_each_split([&](SplitId s) { bound(s); });
  }

 private:
  static constexpr std::size_t block_size = 64;

  // Subtrees become runs: that of the split at place p of the order is places [p, p + size).
  void order_depth_first() {
    place_.resize(splits_);
    sizes_.assign(splits_, 1);
    for (std::size_t s = splits_; s-- > 0;)
      for (const SplitId child : {data_.nodes[s].child_u, data_.nodes[s].child_v})
        if (child != no_id) sizes_[s] += sizes_[child];
    std::vector<SplitId> stack(data_.roots.rbegin(), data_.roots.rend());
    std::uint32_t next = 0;
    while (!stack.empty()) {
      const SplitId s = stack.back();
      stack.pop_back();
      place_[s] = next++;
      for (const SplitId child : {data_.nodes[s].child_v, data_.nodes[s].child_u})
        if (child != no_id) stack.push_back(child);
    }
  }

  template <typename Visit>
  void for_each_own_face(SplitId s, const Visit& visit) const {
    const SplitStar star(data_.stars.data() + data_.nodes[s].star,
                         static_cast<VertexId>(data_.positions.size() - splits_ + s));
    star.for_each_inserted(visit);
    star.for_each_removed([&](const FaceRef&, const Triangle& t) { visit(t); });
  }

  template <typename Visit>
  void for_each_split(const Visit& visit) const {
    for_each_range(splits_, threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) visit(static_cast<SplitId>(s));
    });
  }

  // Patches of own faces; boxes and mean normals of subtrees, from fine to coarse.
  void boxes_of_subtrees() {
    boxes_.resize(splits_);
    for_each_split([&](SplitId s) { boxes_[s] = own_patch(s, patches_[place_[s]]); });
    mean_normals_.assign(splits_, glm::dvec3(0.0));
    for (std::size_t i = splits_; i-- > 0;) {
      const auto s = static_cast<SplitId>(i);
      Box& box = boxes_[s];
      if (patches_[place_[s]].has_normal) mean_normals_[s] += glm::dvec3(patches_[place_[s]].axis);
      for (const SplitId child : {data_.nodes[s].child_u, data_.nodes[s].child_v}) {
        if (child == no_id) continue;
        box.min = glm::min(box.min, boxes_[child].min);
        box.max = glm::max(box.max, boxes_[child].max);
        mean_normals_[s] += mean_normals_[child];
      }
    }
  }

  // Returns the box of the split's own faces.
  Box own_patch(SplitId s, Patch& patch) const {
    const glm::vec3& own = data_.positions[data_.positions.size() - splits_ + s];
    Box box{own, own};
    glm::vec3 sum(0.0F);
    std::array<glm::vec3, 32> normals;  // of the first faces; few splits have more
    std::size_t faces = 0;
    for_each_own_face(s, [&](const Triangle& t) {
      const glm::vec3 &a = data_.positions[t.x], &b = data_.positions[t.y], &c = data_.positions[t.z];
      box.min = glm::min(box.min, glm::min(a, glm::min(b, c)));
      box.max = glm::max(box.max, glm::max(a, glm::max(b, c)));
      const glm::vec3 normal = unit_normal(a, b, c);
      if (faces < normals.size()) normals[faces] = normal;
      ++faces;
      sum += normal;
    });
    patch.axis = unit_or(glm::dvec3(sum), glm::vec3(0, 0, 1));
    patch.sphere.center = 0.5F * box.min + 0.5F * box.max;
    const auto distance2 = [&](const glm::vec3& p) {
      return glm::dot(p - patch.sphere.center, p - patch.sphere.center);
    };
    float radius2 = distance2(own);
    std::size_t i = 0;
    for_each_own_face(s, [&](const Triangle& t) {
      const glm::vec3 &a = data_.positions[t.x], &b = data_.positions[t.y], &c = data_.positions[t.z];
      radius2 = std::max({radius2, distance2(a), distance2(b), distance2(c)});
      const glm::vec3 normal = i < normals.size() ? normals[i] : unit_normal(a, b, c);
      ++i;
      if (normal == glm::vec3(0.0F)) return;
      patch.has_normal = true;
      patch.cos_angle = std::min(patch.cos_angle, glm::dot(patch.axis, normal));
      patch.sin_angle = std::max(patch.sin_angle, glm::length(glm::cross(patch.axis, normal)));
    });
    patch.sphere.radius = std::sqrt(radius2) * grow;
    if (patch.cos_angle <= 0.0F) patch.cos_angle = -1.0F;
    return box;
  }

  // The largest distance from `center` to a point of the box.
  static float reach(const glm::vec3& center, const Box& box) {
    return glm::length(glm::max(box.max - center, center - box.min)) * grow;
  }

  // Zero for a face without area: it covers no pixel and faces nowhere. In double precision: the corners of a sliver
  // are nearly on a line.
  static glm::vec3 unit_normal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::dvec3 from(a);
    const glm::dvec3 normal = glm::cross(glm::dvec3(b) - from, glm::dvec3(c) - from);
    const double length2 = glm::dot(normal, normal);
    return length2 > 0.0 ? glm::vec3(normal / std::sqrt(length2)) : glm::vec3(0.0F);
  }

  // One patch for each block_size patches in a row.
  static void join(const std::vector<Patch>& patches, std::vector<Patch>& blocks) {
    for (std::size_t first = 0; first < patches.size(); first += block_size) {
      const std::size_t end = std::min(first + block_size, patches.size());
      Patch block;
      glm::dvec3 normal(0.0);
      glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
      for (std::size_t i = first; i < end; ++i) {
        if (patches[i].has_normal) normal += glm::dvec3(patches[i].axis);
        low = glm::min(low, patches[i].sphere.center - patches[i].sphere.radius);
        high = glm::max(high, patches[i].sphere.center + patches[i].sphere.radius);
      }
      block.axis = unit_or(normal, glm::vec3(0, 0, 1));
      block.sphere.center = 0.5F * low + 0.5F * high;
      for (std::size_t i = first; i < end; ++i) {
        const Sphere& sphere = patches[i].sphere;
        block.sphere.radius =
            std::max(block.sphere.radius, glm::distance(block.sphere.center, sphere.center) + sphere.radius);
        block.cos_angle = widen(block.cos_angle, block.axis, patches[i]);
        block.has_normal = block.has_normal || patches[i].has_normal;
      }
      block.sphere.radius *= grow;
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

  // All bounds are around the middle of the box. The paper's axis is the normal of the split vertex; the mean normal of
  // the subtree is that of its surface at every level.
  void bound(SplitId s) {
    SplitNode& node = data_.nodes[s];
    const Box& box = boxes_[s];
    const glm::vec3 center = 0.5F * box.min + 0.5F * box.max;
    node.bounds.set_axis(unit_or(mean_normals_[s], glm::vec3(0, 0, 1)));
    const glm::vec3 axis = node.bounds.unpack_axis();
    Cylinder cylinder{center, 0.0F, axis, std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()};
    float radius = 0.0F;
    float cos_angle = 1.0F;
    bool has_normal = false;
    for_each_patch(place_[s], place_[s] + sizes_[s], [&](const Patch& patch) {
      const glm::vec3 offset = patch.sphere.center - center;
      const float along = glm::dot(offset, axis);
      radius = std::max(radius, glm::length(offset) + patch.sphere.radius);
      cylinder.radius = std::max(cylinder.radius, glm::length(offset - along * axis) + patch.sphere.radius);
      cylinder.t_min = std::min(cylinder.t_min, along - patch.sphere.radius);
      cylinder.t_max = std::max(cylinder.t_max, along + patch.sphere.radius);
      cos_angle = widen(cos_angle, axis, patch);
      has_normal = has_normal || patch.has_normal;
    });
    const float slack = radius * (grow - 1.0F);
    // A sphere around the box holds everything as well.
    node.sphere = {center, std::min(radius + slack, reach(center, box))};
    cylinder.radius = std::min(cylinder.radius + slack, node.sphere.radius);
    cylinder.t_min = std::max(cylinder.t_min - slack, -node.sphere.radius);
    cylinder.t_max = std::min(cylinder.t_max + slack, node.sphere.radius);
    node.bounds.set_cone(has_normal ? cos_angle : -1.0F);
    node.bounds.set_cylinder(node.sphere, cylinder);
    node.bounds.set_box(node.sphere, box);
  }

  HierarchyData& data_;
  unsigned threads_;
  std::size_t splits_;
  std::vector<std::uint32_t> place_;  // of each split in depth-first order
  std::vector<std::uint32_t> sizes_;  // of each split's subtree
  std::vector<Patch> patches_;        // of each split's own faces, in depth-first order
  std::vector<Patch> blocks_, large_blocks_;
  std::vector<Box> boxes_;  // of subtrees
  std::vector<glm::dvec3> mean_normals_;
};

}  // namespace

void bound_subtrees(HierarchyData& data, unsigned threads) { SubtreeBounds(data, threads).run(); }

}  // namespace occlod
