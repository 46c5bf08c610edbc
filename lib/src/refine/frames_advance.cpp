#include <algorithm>
#include <cmath>

#include "refine/frames.h"

namespace occlod {
namespace {

// More changes than this part of the nodes of the front.
constexpr double much_change = 0.03;
// When so many candidates need more triangles than are left, the budget counts as used up.
constexpr std::size_t most_rejections = 16;
constexpr std::size_t least_gain = 1;  // of triangles, by a split: one at a border

}  // namespace

void Frames::advance(Questions& questions, Occluder& occluder, bool moved, Clock::time_point start,
                     RefineStats& stats) {
  questions_ = &questions;
  stats_ = &stats;
  start_ = start;
  if (moved) moved_frame_ = frame_;
  if (moved) fresh_draw_ = draw_ + 1;
  const bool can_hide = questions.can_hide();
  if (!can_hide) forget_hidden();
  if (can_hide) ask_again(occluder, false);
  gather();
  run();
  if (can_hide && moved && options_->queries.final_check && has_changed_much()) {
    let_new_ones_go();
    fresh_draw_ = draw_ + 1;
    asks_leaves_ = true;
    ask_again(occluder, true);
    gather();
    run();
    asks_leaves_ = false;
  }
  take_back_needless();
  measure_errors();
  before_ = count_applied();
  const bool all_asked = !can_hide || frame_ - moved_frame_ >= asking_rounds;
  at_rest_ = changes_ == 0 && !stats.pending && all_asked;
  stats.triangles = triangles_;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    stats.culled_frustum += count(errors(i), {.all = Front::outside});
    stats.culled_backface += count(errors(i), {.all = Front::facing_away});
  }
  stats.level_px = static_cast<double>(level_);
  stats.max_error_px = static_cast<double>(left_.guaranteed_px);
  stats.max_quadric_error_px = static_cast<double>(left_.quadric_px);
}

// So much that the mesh which hid things in this frame is not the one that is handed over.
bool Frames::has_changed_much() const {
  std::size_t nodes = 0;
  for (const Object& object : objects_) nodes += object.front.size();
  return static_cast<double>(changes_) > much_change * static_cast<double>(nodes);
}

// Splits of this frame may be taken back too, once a better occluder is there.
void Frames::let_new_ones_go() {
  for (Object& object : objects_)
    for (Front::Index k = 0; k < object.front.size(); ++k) object.front.set(k, Front::is_new, false);
}

void Frames::run() {
  std::size_t rejections = 0;
  level_ = 0.0F;
  while (true) {
    if (triangles_ > options_->budget) {
      if (!take_back_least()) break;
      continue;
    }
    if (candidates_.empty() || candidates_.top().priority <= candidates_above_) gather_more_candidates();
    if (candidates_.empty()) return;
    if (limit_reached()) break;
    Entry entry = candidates_.pop();
    ++stats_->visits;
    if (is_hidden(entry)) continue;
    if (entry.kind == Entry::Kind::visit) {
      descend(entry);
    } else if (!apply(entry)) {
      // What comes later matters less and takes no room from leaves either: it can only fit into what is left.
      level_ = std::max(level_, entry.priority);
      ++stats_->rejected_splits;
      left_.include(entry.error);
      if (++rejections == most_rejections || triangles_ + least_gain > options_->budget) return;
    }
  }
  stats_->pending = !candidates_.empty();
  if (stats_->pending) level_ = std::max(level_, candidates_.top().priority);
}

bool Frames::limit_reached() const {
  if (options_->update.most_changes > 0 && changes_ >= options_->update.most_changes) return true;
  return options_->update.time_limit_ms > 0.0 && milliseconds_since(start_) >= options_->update.time_limit_ms;
}

void Frames::descend(const Entry& entry) {
  const std::uint32_t i = entry.object;
  Front& front = objects_[i].front;
  reached_.clear();
  descend_from(i, entry.split, [&](SplitId child) { reached_.push_back(front.find(child)); });
  renew(i, reached_);
  for (const Front::Index k : reached_) {
    const ScreenError error = front.error_at_most(k);
    if (error.quadric_px > 0.0F && !front.is(k, Front::subtree_hidden) && !is_tolerated(error))
      candidates_.push({error.quadric_px, error, front.node(k).split, i, front.node(k).level, 0, Entry::Kind::visit});
  }
  const Front::Index k = front.find(entry.split);
  if (!front.is(k, Front::applied)) offer(i, k);
}

// The split of a node that is reached, if it is worth anything.
void Frames::offer(std::uint32_t i, Front::Index k) {
  const Worth value = worth(i, k);
  const FrontNode& node = objects_[i].front.node(k);
  if (value.raw > 0.0F && !is_tolerated(value.error))
    candidates_.push({value.raw, value.error, node.split, i, node.level, 0, Entry::Kind::apply});
}

// False when there is no room for it at its priority with what it forces.
bool Frames::apply(Entry& entry) {
  Cut& cut = refined_.cuts[entry.object];
  if (cut.applied(entry.split)) return true;
  Cut::Closure closure = cut.closure(entry.split);
  if (waits(entry, closure)) return true;
  while (triangles_ + closure.triangles > options_->budget) {
    if (!make_room(entry.priority)) return false;
    closure = cut.closure(entry.split);
  }
  apply_closure(entry.object, closure);
  return true;
}

// Culling::star: a split that forces others which nobody sees steps back in the queue, once in a frame.
bool Frames::waits(Entry& entry, const Cut::Closure& closure) {
  if (options_->priority.culling != Culling::star || entry.weighed) return false;
  Front& front = objects_[entry.object].front;
  const Front::Index k = front.find(entry.split);
  front.set(k, Front::weighed, true);
  float& weight = front.forced_weight(k);
  weight = closure.splits.size() == 1 ? 1.0F : refined_.importances[entry.object].forced_weight(closure.splits);
  entry.weighed = true;
  entry.priority *= weight;
  if (weight == 1.0F || candidates_.would_be_next(entry)) return false;
  candidates_.push(entry);
  return true;
}

void Frames::apply_closure(std::uint32_t i, const Cut::Closure& closure) {
  Object& object = objects_[i];
  Cut& cut = refined_.cuts[i];
  stats_->forced_splits += closure.splits.size() - 1;
  sorted_.assign(closure.splits.begin(), closure.splits.end());
  std::sort(sorted_.begin(), sorted_.end());  // what is needed comes first
  triangles_ -= cut.triangle_count();
  cut.apply_closure();
  triangles_ += cut.triangle_count();
  for (const SplitId s : sorted_) {
    object.faces.apply(s);
    const Front::Index k = object.front.obtain(s);
    for (const Front::Flag flag : {Front::applied, Front::leaf, Front::is_new}) object.front.set(k, flag, true);
    for (const SplitId needed : cut.hierarchy().star(s).dependencies())
      object.front.set(object.front.find(needed), Front::leaf, false);
    object.born.push_back(s);
  }
  changes_ += sorted_.size();
}

// Gives up the least important leaf, if that is worth it for what matters `key`.
bool Frames::make_room(float key) {
  const float most = key * (1.0F - static_cast<float>(options_->update.hysteresis));
  // What is not queued yet matters more than the queue's limit.
  if (leaves_.empty() && (most <= leaves_below_ || !gather_more_leaves())) return false;
  if (!(1.0F / leaves_.top().priority < most)) return false;
  return take_back_least();
}

// Still what it was when it was queued.
bool Frames::is_old_leaf(const Entry& leaf) {
  const Cut& cut = refined_.cuts[leaf.object];
  if (!cut.applied(leaf.split)) return false;
  const Front& front = objects_[leaf.object].front;
  const Front::Index k = front.find(leaf.split);
  return front.is(k, Front::leaf) && !front.is(k, Front::is_new);
}

// False when there is none left.
bool Frames::take_back_least() {
  while (!leaves_.empty() || gather_more_leaves()) {
    const Entry leaf = leaves_.pop();
    if (!is_old_leaf(leaf)) continue;
    take_back(leaf.object, leaf.split);
    return true;
  }
  return false;
}

void Frames::take_back(std::uint32_t i, SplitId s) {
  Object& object = objects_[i];
  Cut& cut = refined_.cuts[i];
  triangles_ -= cut.triangle_count();
  cut.take_back(s);
  triangles_ += cut.triangle_count();
  object.faces.take_back(s);
  object.died.push_back(s);
  ++changes_;
  const Front::Index k = object.front.find(s);
  for (const Front::Flag flag : {Front::applied, Front::leaf, Front::is_new}) object.front.set(k, flag, false);
  if (object.front.is(k, Front::reached))
    offer(i, k);  // it may be wanted again once better leaves have come up
  else
    object.front.remove(k);
  for (const SplitId needed : cut.hierarchy().star(s).dependencies())
    if (cut.is_leaf(needed)) queue_new_leaf(i, needed);
}

void Frames::queue_new_leaf(std::uint32_t i, SplitId s) {
  Front& front = objects_[i].front;
  const Front::Index k = front.find(s);
  front.set(k, Front::leaf, true);
  if (front.is(k, Front::is_new)) return;
  // It may well be hidden too, and then its room is wanted now.
  if (asks_leaves_) static_cast<void>(is_hidden({0.0F, {}, s, i, front.node(k).level, 0, leaf_question()}));
  const float key = leaf_key(i, k);
  if (key < leaves_below_) push_leaf(i, s, key);
}

// Where a tolerance is given: leaves that are seen by nobody, or well within it.
void Frames::take_back_needless() {
  if (!(options_->tolerance_px > 0.0) || stats_->pending) return;
  while (!limit_reached() && !leaves_.empty() && std::isinf(leaves_.top().priority)) {
    const Entry leaf = leaves_.pop();
    if (is_old_leaf(leaf)) take_back(leaf.object, leaf.split);
  }
}

}  // namespace occlod
