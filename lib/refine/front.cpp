#include "refine/front.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/inverse_power_of_two.h"

namespace occlod {
namespace {

// Around the corners of all faces.
Sphere sphere_around(const SplitStar& star, std::span<const glm::vec3> positions) {
  Box box{positions[star.vertex()], positions[star.vertex()]};
  const auto for_each_corner = [&](const auto& visit) {
    star.for_each_face([&](const Triangle& t) {
      for (int k = 0; k < 3; ++k) visit(positions[t[k]]);
    });
  };
  for_each_corner([&](const glm::vec3& p) { box = {glm::min(box.min, p), glm::max(box.max, p)}; });
  const float unit = inverse_power_of_two(box.max - box.min);
  const glm::vec3 center = 0.5F * box.min + 0.5F * box.max;
  float square = 0.0F;
  for_each_corner([&](const glm::vec3& p) {
    const glm::vec3 d = unit * (p - center);
    square = std::max(square, glm::dot(d, d));
  });
  return {center, std::sqrt(square) / unit};
}

FrontStar planes_of(const SplitStar& star, std::span<const glm::vec3> positions) {
  FrontStar planes;
  planes.has_too_many = star.inserted_count() + star.removed_count() > FrontStar::most_faces;
  if (planes.has_too_many) return planes;
  planes.sphere = sphere_around(star, positions);
  const float unit = inverse_power_of_two(planes.sphere.radius);
  star.for_each_face([&](const Triangle& t) {
    const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
    const glm::vec3 normal = glm::cross(unit * (b - a), unit * (c - a));
    const std::size_t i = planes.faces++;
    planes.normal_x[i] = normal.x;
    planes.normal_y[i] = normal.y;
    planes.normal_z[i] = normal.z;
    planes.offset[i] = glm::dot(normal, planes.sphere.center - a);
    planes.length[i] = glm::length(normal);
  });
  return planes;
}

}  // namespace

Front::Front(const Hierarchy& hierarchy, bool attributes)
    : hierarchy_(&hierarchy), attributes_(attributes), slots_(zeroed_array<std::uint32_t>(hierarchy.split_count())) {}

void Front::clear() {
  for (const FrontNode& node : nodes_) slots_[node.split] = 0;
  nodes_.clear();
  flags_.clear();
  errors_.clear();
  guaranteed_errors_.clear();
  visible_shares_.clear();
  forced_weights_.clear();
  scales_.clear();
  priorities_.clear();
  stars_.clear();
  free_stars_.clear();
}

Front::Index Front::obtain(SplitId s) {
  if (const Index there = find(s); there != none) return there;
  hierarchy_->require(s);
  const SplitNode& split = hierarchy_->node(s);
  nodes_.push_back({split.sphere, split.cone(), s});
  flags_.push_back(0);
  const SplitErrors errors = errors_of(*hierarchy_, s, attributes_);
  errors_.push_back(errors.mean);
  guaranteed_errors_.push_back(errors.guaranteed);
  visible_shares_.push_back(0.0F);
  forced_weights_.push_back(1.0F);
  scales_.add();
  priorities_.add();
  slots_[s] = static_cast<std::uint32_t>(nodes_.size());
  return slots_[s] - 1;
}

void Front::remove(Index k) {
  if (nodes_[k].star != FrontNode::no_star) free_stars_.push_back(nodes_[k].star);
  const SplitId gone = nodes_[k].split;
  slots_[nodes_.back().split] = slots_[gone];
  slots_[gone] = 0;
  const auto take_last = [&](auto& of) {
    of[k] = of.back();
    of.pop_back();
  };
  take_last(nodes_);
  take_last(flags_);
  take_last(errors_);
  take_last(guaranteed_errors_);
  take_last(visible_shares_);
  take_last(forced_weights_);
  scales_.remove(k);
  priorities_.remove(k);
}

void Front::set(Index k, Flag flag, bool on) noexcept {
  const unsigned one = flags_[k], changed = on ? one | flag : one & ~unsigned{flag};
  const bool any_hidden = (changed & (subtree_hidden | star_hidden)) != 0;
  flags_[k] = static_cast<std::uint16_t>(any_hidden ? changed | hidden : changed & ~unsigned{hidden});
}

const FrontStar& Front::star(Index k) {
  FrontNode& node = nodes_[k];
  if (node.star == FrontNode::no_star) {
    const SplitStar star = hierarchy_->star(node.split);
    star.for_each_face([&](const Triangle& t) {
      for (int corner = 0; corner < 3; ++corner) hierarchy_->require_vertex(t[corner]);
    });
    if (free_stars_.empty()) {
      free_stars_.push_back(static_cast<std::uint32_t>(stars_.size()));
      stars_.emplace_back();
    }
    node.star = free_stars_.back();
    free_stars_.pop_back();
    stars_[node.star] = planes_of(star, hierarchy_->positions());
  }
  return stars_[node.star];
}

}  // namespace occlod
