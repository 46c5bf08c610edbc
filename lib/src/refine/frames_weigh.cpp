// What nodes are worth, and which of them a frame looks at.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "priority/front_priority.h"
#include "priority/weighed_lanes.h"
#include "refine/frames.h"

namespace occlod {
namespace {

// More than this part of the applied splits matters much less than what the budget goes to.
constexpr double lost_part = 0.25;
// What a split forces is looked at again in one frame of so many.
constexpr std::uint32_t weighing_rounds = 8;
// Sums of motion from here on count as rounded too much: in diagonals of the object, and in radians.
constexpr double most_motion = 64.0;
// Diagonals of objects beyond which sums of squares of what is seen near them might be out of the range of floats.
constexpr double least_diagonal = 0x1p-40, most_diagonal = 0x1p40;
constexpr ErrorGrowth while_unseen = {0.0F, 0.0F, std::numeric_limits<float>::max(), 0.0F,
                                      std::numeric_limits<float>::max()};

}  // namespace

BoundedProducts Frames::errors(std::uint32_t object) const {
  const Object& of = objects_[object];
  return {of.front.scales(), of.front.errors(), of.front.flags()};
}

BoundedProducts Frames::guaranteed_errors(std::uint32_t object) const {
  const Object& of = objects_[object];
  return {of.front.scales(), of.front.guaranteed_errors(), of.front.flags()};
}

BoundedProducts Frames::priorities(std::uint32_t object) const {
  if (options_->priority.culling == Culling::subtree) return errors(object);
  const Object& of = objects_[object];
  return {of.front.priorities(), {}, of.front.flags()};
}

BoundedProducts Frames::leaf_priorities(std::uint32_t object) const {
  if (options_->priority.culling == Culling::subtree) return errors(object);
  const Object& of = objects_[object];
  return {of.front.priorities(), of.front.forced_weights(), of.front.flags()};
}

bool Frames::weigh(const RefinedCuts& refined, const RefineOptions& options) {
  begin(refined, options);
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    motion(i);
    renew_outdated(i);
  }
  last_view_ = *refined_.view;
  const Applied now = count_applied();
  const double newly_lost = static_cast<double>(now.worthless) - static_cast<double>(before_.worthless);
  return newly_lost <= lost_part * static_cast<double>(now.all);
}

// To the view of this frame. Nothing is known any more when that is of another kind.
void Frames::motion(std::uint32_t object) {
  Object& of = objects_[object];
  const ObjectView& view = refined_.views[object];
  const std::optional<ViewMotion> moved =
      motion_between({*last_view_, *of.view}, {*refined_.view, view}, middle_of(object));
  of.view = view;
  if (moved) {
    of.motion.eye_distance += moved->eye_distance;
    of.motion.center_distance += moved->center_distance;
    of.motion.rotation_rad += moved->rotation_rad;
    const Box& box = refined_.cuts[object].hierarchy().box();
    const double diagonal = glm::distance(glm::dvec3(box.min), glm::dvec3(box.max));
    if (diagonal >= least_diagonal && diagonal <= most_diagonal &&
        std::max(of.motion.eye_distance, of.motion.center_distance) <= most_motion * diagonal &&
        of.motion.rotation_rad <= most_motion) {
      of.front.scales().update(of.motion);
      if (options_->priority.culling == Culling::star) of.front.priorities().update(of.motion);
      return;
    }
  }
  of.motion = {};
  of.front.scales().forget_all();
  of.front.priorities().forget_all();
}

glm::vec3 Frames::middle_of(std::uint32_t object) const {
  const Box& box = refined_.cuts[object].hierarchy().box();
  return 0.5F * box.min + 0.5F * box.max;
}

// Finds the scales of these nodes for this frame's view, if that has not been done.
void Frames::renew(std::uint32_t object, std::span<const Front::Index> nodes) {
  Object& of = objects_[object];
  renewed_.clear();
  for (const Front::Index k : nodes)
    if (!of.front.scales().is_exact(k)) renewed_.push_back(k);
  weigh_nodes(of.front, renewed_,
              {refined_.views[object], refined_.gate->tests_cone(object), of.motion, middle_of(object)});
}

void Frames::renew_outdated(std::uint32_t object) {
  found_.clear();
  const BoundedValues& scales = objects_[object].front.scales();
  for (Front::Index k = 0; k < scales.value.size(); ++k)
    if (scales.is_outdated(k)) found_.push_back(k);
  renew(object, found_);
}

// What the split of a node is worth in this view.
Frames::Worth Frames::worth(std::uint32_t object, Front::Index k) {
  Object& of = objects_[object];
  Front& front = of.front;
  const bool by_star = options_->priority.culling == Culling::star;
  // A star has a scale of its own: whether the node is seen is known from frames before.
  if (!by_star || front.scales().is_outdated(k)) renew(object, {&k, 1});
  if (front.is(k, Front::hidden)) return {};
  if (!(front.scales().value[k] > 0.0F)) {
    front.priorities().put(k, 0.0F, while_unseen, of.motion);
    return {};
  }
  if (by_star) return worth_by_star(object, k);
  const ScreenError error = front.error_at_most(k);
  return {error.quadric_px, error.quadric_px, error};
}

Frames::Worth Frames::worth_by_star(std::uint32_t object, Front::Index k) {
  Object& of = objects_[object];
  Importance& importance = refined_.importances[object];
  const ObjectView& view = refined_.views[object];
  const FrontStar& star = of.front.star(k);
  FrontPriority found;
  if (!star.has_too_many && is_wholly_inside(star.sphere, view))
    found = front_priority(
        star, of.front.errors()[k], of.front.guaranteed_errors()[k],
        {view, importance, refined_.objects[object].two_sided, static_cast<float>(options_->priority.grazing_exponent),
         static_cast<float>(2.0 * tan_corner_angle(view)), middle_of(object)});
  else
    found.value = importance.of(of.front.node(k).split);
  const bool is_seen = found.value.visible_share > 0.0F;
  const float priority = is_seen ? found.value.priority : 0.0F;
  of.front.priorities().put(k, priority, found.growth, of.motion);
  if (!is_seen) return {};
  return {priority * of.front.forced_weight(k), priority, found.value.error};
}

bool Frames::is_tolerated(const ScreenError& error) const {
  return options_->tolerance_px > 0.0 && error.guaranteed_px <= static_cast<float>(options_->tolerance_px);
}

// Reached nodes, at which refinement may go on.
void Frames::gather_candidates(float low, float high) {
  const auto within = [&](float key) { return key > low && key <= high; };
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    Front& front = objects_[i].front;
    found_.clear();
    select(errors(i), {.all = Front::reached, .none = Front::descended | Front::subtree_hidden, .may_exceed = low},
           found_);
    renew(i, found_);
    for (const Front::Index k : found_) {
      const ScreenError bound = front.error_at_most(k);
      const FrontNode& node = front.node(k);
      if (within(bound.quadric_px) && !is_tolerated(bound))
        candidates_.push({bound.quadric_px, bound, node.split, i, node.level, 0, Entry::Kind::visit});
    }
    found_.clear();
    select(priorities(i),
           {.all = Front::reached | Front::descended, .none = Front::applied | Front::hidden, .may_exceed = low},
           found_);
    if (options_->priority.culling == Culling::subtree) renew(i, found_);
    for (const Front::Index k : found_) {
      const bool again = !front.is(k, Front::weighed) || (front.node(k).split + frame_) % weighing_rounds == 0;
      const Worth value = worth(i, k);
      const float key = again ? value.raw : value.key;
      const FrontNode& node = front.node(k);
      if (within(key) && !is_tolerated(value.error))
        candidates_.push({key, value.error, node.split, i, node.level, 0, Entry::Kind::apply, !again});
    }
  }
}

// 0 for what a tolerance makes needless; finite, also with the eye inside the bounds, so that everything can be given
// up.
float Frames::leaf_key(std::uint32_t object, Front::Index k) {
  const Worth value = worth(object, k);
  const double needless = options_->tolerance_px * (1.0 - options_->update.hysteresis);
  if (static_cast<double>(value.error.guaranteed_px) <= needless) return 0.0F;
  return std::min(value.key, std::numeric_limits<float>::max());
}

// Applied splits that none needs.
void Frames::gather_leaves(float low, float high) {
  constexpr std::uint16_t wanted = Front::applied | Front::leaf;
  const float may_be_below = options_->tolerance_px > 0.0 ? std::numeric_limits<float>::infinity() : high;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    found_.clear();
    select(errors(i), {.all = wanted | Front::hidden, .none = Front::is_new}, found_);
    select(leaf_priorities(i), {.all = wanted, .none = Front::is_new | Front::hidden, .may_be_below = may_be_below},
           found_);
    if (options_->priority.culling == Culling::subtree) renew(i, found_);
    for (const Front::Index k : found_) {
      const float key = leaf_key(i, k);
      if (key >= low && key < high) push_leaf(i, objects_[i].front.node(k).split, key);
    }
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
  last_step_ = closing * level_;
  leaves_below_ = level_ * band;
  // All of them where the budget is enough: some may be needless.
  if (level_ == 0.0F && options_->tolerance_px > 0.0) leaves_below_ = std::numeric_limits<float>::infinity();
  gather_candidates(candidates_above_, std::numeric_limits<float>::infinity());
  gather_leaves(0.0F, leaves_below_);
}

// Until there is one that comes before all that is not queued yet: a little less important ones each time, then the
// rest.
void Frames::gather_more_candidates() {
  while (candidates_above_ > 0.0F && (candidates_.empty() || candidates_.top().priority <= candidates_above_)) {
    const float below = candidates_above_;
    candidates_above_ = below > last_step_ ? below / band_step : 0.0F;
    gather_candidates(candidates_above_, below);
  }
}

// The rest.
bool Frames::gather_more_leaves() {
  if (leaves_below_ == std::numeric_limits<float>::infinity()) return false;
  const float from = std::exchange(leaves_below_, std::numeric_limits<float>::infinity());
  gather_leaves(from, leaves_below_);
  return !leaves_.empty();
}

// The largest error of what is held to be visible and is not refined. Only what may be it is weighed and looked at.
void Frames::measure_errors() {
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    measure_unreached(i, errors(i), left_.quadric_px);
    measure_unreached(i, guaranteed_errors(i), left_.guaranteed_px);
  }
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    measure_unapplied(i, errors(i), left_.quadric_px);
    measure_unapplied(i, guaranteed_errors(i), left_.guaranteed_px);
  }
}

// By the bounds of subtrees that have not been descended.
void Frames::measure_unreached(std::uint32_t object, const BoundedProducts& of, float so_far) {
  constexpr std::uint16_t all = Front::reached, none = Front::descended | Front::subtree_hidden;
  found_.clear();
  const float least = (1.0F - 1e-6F) * std::max(so_far, largest_at_least(of, all, none));
  select(of, {.all = all, .none = none, .may_exceed = least}, found_);
  renew(object, found_);
  for (const Front::Index k : found_) left_.include(objects_[object].front.error_at_most(k));
}

// By stars of splits, where their subtree's bounds leave room for a larger one.
void Frames::measure_unapplied(std::uint32_t object, const BoundedProducts& of, float so_far) {
  constexpr std::uint16_t all = Front::reached | Front::descended, none = Front::applied | Front::hidden;
  found_.clear();
  select(of, {.all = all, .none = none, .may_exceed = so_far}, found_);
  const BoundedValues& known = priorities(object).values;
  Front& front = objects_[object].front;
  for (const Front::Index k : found_) {
    if (options_->priority.culling == Culling::subtree || known.is_outdated(k))
      left_.include(worth(object, k).error);
    else if (known.value[k] > 0.0F)  // still seen
      left_.include({front.errors()[k], front.guaranteed_errors()[k],
                     refined_.views[object].largest_scale_px(front.star(k).sphere)});
  }
}

}  // namespace occlod
