#include "frames.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "front_look.h"
#include "occlod/core/error.h"

namespace occlod {
namespace {

// Nodes are no longer descended when they matter less than this part of the level.
constexpr float closing = 0.5F;
// What a split forces is looked at again in one frame of so many.
constexpr std::uint32_t weighing_rounds = 4;
// More than this part of the applied splits matters much less than what the budget goes to.
constexpr double lost_part = 0.25;

}  // namespace

Frames::Frames(std::span<const RefineObject> objects) {
  for (const RefineObject& object : objects) objects_.emplace_back(*object.hierarchy);
}

void Frames::begin(const RefinedCuts& refined, const RefineOptions& options) {
  refined_ = refined;
  options_ = &options;
  ++frame_;
  adopted_ = false;
  changes_ = 0;
  unseen_ = {};
  triangles_ = 0;
  for (const Cut& cut : refined_.cuts) triangles_ += cut.triangle_count();
  for (Object& object : objects_) {
    object.faces.begin_frame();
    object.born.clear();
    object.died.clear();
  }
  left_ = {};
}

void Frames::adopt(const RefinedCuts& refined, const RefineOptions& options, float level,
                   std::span<const Entry> hidden) {
  begin(refined, options);
  adopted_ = true;
  adopted_draw_ = draw_;
  at_rest_ = false;
  level_ = level;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    Object& object = objects_[i];
    object.front.clear();
    object.morphs.clear();
    object.faces.assign(refined.cuts[i]);
    for (const SplitId s : refined.cuts[i].applied_splits())
      if (refined.cuts[i].applied(s)) object.front.obtain(s).set(FrontNode::applied, true);
  }
  for (const Entry& entry : hidden)
    objects_[entry.object]
        .front.obtain(entry.split)
        .set(entry.kind == Entry::Kind::visit ? FrontNode::subtree_hidden : FrontNode::star_hidden, true);
  for (std::uint32_t i = 0; i < objects_.size(); ++i) adopt_forest(i);
  before_ = count_applied();
}

void Frames::adopt_forest(std::uint32_t object) {
  Front& front = objects_[object].front;
  open_.clear();
  for (const SplitId root : refined_.cuts[object].hierarchy().data().roots) {
    reach(object, root, no_id, 0);
    open_.push_back(root);
  }
  while (!open_.empty()) {
    const SplitId s = open_.back();
    open_.pop_back();
    FrontNode& node = *front.find(s);
    if (node.is(FrontNode::subtree_hidden) || !(node.quadric_px() > level_)) continue;
    descend_from(object, s, [&](SplitId child) { open_.push_back(child); });
  }
  for (std::size_t k = front.nodes().size(); k-- > 0;) {
    FrontNode& node = front.nodes()[k];
    if (!node.is(FrontNode::reached) && !node.is(FrontNode::applied)) front.remove(node);
  }
}

void Frames::reach(std::uint32_t object, SplitId s, SplitId parent, std::uint16_t level) {
  const Hierarchy& hierarchy = refined_.cuts[object].hierarchy();
  hierarchy.require(s);
  if (hierarchy.node(s).parent != parent)
    throw Error({"hierarchy", "split " + std::to_string(s), "is not where its parent says", "build it again"});
  FrontNode& node = objects_[object].front.obtain(s);
  node.set(FrontNode::reached, true);
  node.level = level;
  node.scale_px = scale_px_of(node, refined_.views[object], refined_.gate->tests_cone(object), unseen_);
}

bool Frames::weigh(const RefinedCuts& refined, const RefineOptions& options) {
  begin(refined, options);
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const std::span<FrontNode> nodes = objects_[i].front.nodes();
    const WeighedNodes counts = weigh_nodes(nodes, refined_.views[i], refined_.gate->tests_cone(i));
    unseen_.outside += counts.outside;
    unseen_.facing_away += counts.facing_away;
  }
  const Applied now = count_applied();
  const double newly_lost = static_cast<double>(now.worthless) - static_cast<double>(before_.worthless);
  return newly_lost <= lost_part * static_cast<double>(now.all);
}

Frames::Applied Frames::count_applied() const {
  Applied count;
  for (const Object& object : objects_)
    for (const FrontNode& node : object.front.nodes()) {
      if (!node.is(FrontNode::applied)) continue;
      ++count.all;
      if (is_closable(node)) ++count.worthless;
    }
  return count;
}

// What the split of a node is worth.
Frames::Worth Frames::worth(std::uint32_t object, FrontNode& node) {
  if (!(node.scale_px > 0.0F) || node.is(FrontNode::subtree_hidden) || node.is(FrontNode::star_hidden)) return {};
  if (options_->culling == Culling::subtree) {
    const ScreenError error(node.error, node.guaranteed_error, node.scale_px);
    return {error.quadric_px, error.quadric_px, error};
  }
  Importance& importance = refined_.importances[object];
  const ObjectView& view = refined_.views[object];
  const FrontStar& star = objects_[object].front.star(node);
  const Importance::Value value =
      !star.has_too_many && is_wholly_inside(star.sphere, view)
          ? importance.of(look(star, view, refined_.objects[object].two_sided), node.error, node.guaranteed_error)
          : importance.of(node.split);
  if (value.visible_share == 0.0F) return {};
  return {value.priority * node.forced_weight, value.priority, value.error};
}

bool Frames::is_tolerated(const ScreenError& error) const {
  return options_->tolerance_px > 0.0 && error.guaranteed_px <= static_cast<float>(options_->tolerance_px);
}

// Gives up nodes that matter too little to be descended.
void Frames::close(std::uint32_t object) {
  open_.clear();
  for (const FrontNode& node : objects_[object].front.nodes())
    if (node.is(FrontNode::descended) && is_closable(node)) open_.push_back(node.split);
  for (const SplitId first : open_)
    for (SplitId s = first; s != no_id && close_one(object, s);) s = refined_.cuts[object].hierarchy().node(s).parent;
}

bool Frames::is_closable(const FrontNode& node) const {
  return node.is(FrontNode::subtree_hidden) || !(node.quadric_px() > closing * level_);
}

bool Frames::close_one(std::uint32_t object, SplitId s) {
  Front& front = objects_[object].front;
  FrontNode* const node = front.find(s);
  if (node == nullptr || !node->is(FrontNode::descended) || !is_closable(*node)) return false;
  const SplitNode& split = refined_.cuts[object].hierarchy().node(s);
  for (const SplitId child : {split.child_u, split.child_v})
    if (child != no_id && front.find(child)->is(FrontNode::descended)) return false;
  node->set(FrontNode::descended, false);
  for (const SplitId child : {split.child_u, split.child_v}) {
    if (child == no_id) continue;
    FrontNode& below = *front.find(child);
    below.set(FrontNode::reached, false);
    if (!below.is(FrontNode::applied)) front.remove(below);
  }
  return true;
}

// Reached nodes, at which refinement may go on.
void Frames::gather_candidates(float low, float high) {
  const auto within = [&](float key) { return key > low && key <= high; };
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    std::span<FrontNode> nodes = objects_[i].front.nodes();
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      FrontNode& node = nodes[k];
      if (!node.is(FrontNode::reached) || !(node.scale_px > 0.0F) || node.is(FrontNode::subtree_hidden)) continue;
      const ScreenError bound(node.error, node.guaranteed_error, node.scale_px);
      if (!node.is(FrontNode::descended)) {
        if (within(bound.quadric_px) && !is_tolerated(bound))
          candidates_.push({bound.quadric_px, bound, node.split, i, node.level, 0, Entry::Kind::visit});
      } else if (!node.is(FrontNode::applied) && bound.quadric_px * most_grazing > low) {
        const bool again = (k + frame_) % weighing_rounds == 0;
        const Worth value = worth(i, node);
        const float key = again ? value.raw : value.key;
        if (within(key) && !is_tolerated(value.error))
          candidates_.push({key, value.error, node.split, i, node.level, 0, Entry::Kind::apply, !again});
      }
    }
  }
}

// 0 for what a tolerance makes needless; finite, also with the eye inside the bounds, so that everything can be given
// up.
float Frames::leaf_key(std::uint32_t object, FrontNode& node) {
  const Worth value = worth(object, node);
  const double needless = options_->tolerance_px * (1.0 - options_->hysteresis);
  if (static_cast<double>(value.error.guaranteed_px) <= needless) return 0.0F;
  return std::min(value.key, std::numeric_limits<float>::max());
}

// Applied splits that none needs.
void Frames::gather_leaves(float low, float high) {
  for (std::uint32_t i = 0; i < objects_.size(); ++i)
    for (FrontNode& node : objects_[i].front.nodes()) {
      if (!node.is(FrontNode::applied) || node.is(FrontNode::is_new) || !refined_.cuts[i].is_leaf(node.split)) continue;
      const float key = leaf_key(i, node);
      if (key >= low && key < high) push_leaf(i, node.split, key);
    }
}

void Frames::push_leaf(std::uint32_t object, SplitId s, float key) {
  leaves_.push({1.0F / key, {}, s, object});  // infinite for what is worth nothing
}

void Frames::gather() {
  candidates_.clear();
  leaves_.clear();
  for (std::uint32_t i = 0; i < objects_.size(); ++i) close(i);
  candidates_above_ = level_ / band;
  leaves_below_ = level_ * band;
  // All of them where the budget is enough: some may be needless.
  if (level_ == 0.0F && options_->tolerance_px > 0.0) leaves_below_ = std::numeric_limits<float>::infinity();
  gather_candidates(candidates_above_, std::numeric_limits<float>::infinity());
  gather_leaves(0.0F, leaves_below_);
}

// Queues the rest, once.
void Frames::gather_more_candidates() {
  const float below = std::exchange(candidates_above_, 0.0F);
  if (below > 0.0F) gather_candidates(0.0F, below);
}

bool Frames::gather_more_leaves() {
  if (leaves_below_ == std::numeric_limits<float>::infinity()) return false;
  const float from = std::exchange(leaves_below_, std::numeric_limits<float>::infinity());
  gather_leaves(from, leaves_below_);
  return !leaves_.empty();
}

// The largest error of what is held to be visible and is not refined. Stars are looked at only where their subtree's
// bounds leave room for a larger one.
void Frames::measure_errors() {
  const auto for_each_reached = [&](bool descended, const auto& visit) {
    for (std::uint32_t i = 0; i < objects_.size(); ++i)
      for (FrontNode& node : objects_[i].front.nodes())
        if (node.is(FrontNode::reached) && node.is(FrontNode::descended) == descended && node.scale_px > 0.0F &&
            !node.is(FrontNode::subtree_hidden))
          visit(i, node, ScreenError(node.error, node.guaranteed_error, node.scale_px));
  };
  for_each_reached(false, [&](std::uint32_t, const FrontNode&, const ScreenError& error) { left_.include(error); });
  for_each_reached(true, [&](std::uint32_t i, FrontNode& node, const ScreenError& bound) {
    if (node.is(FrontNode::applied)) return;
    if (bound.quadric_px > left_.quadric_px || bound.guaranteed_px > left_.guaranteed_px)
      left_.include(worth(i, node).error);
  });
}

}  // namespace occlod
