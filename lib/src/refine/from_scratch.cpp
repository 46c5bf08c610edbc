#include "refine/from_scratch.h"

#include <string>

#include "occlod/core/error.h"
#include "priority/weigh_splits.h"

namespace occlod {
namespace {

// When so many visible splits in a row need more triangles than are left, the budget counts as used up.
constexpr std::size_t most_rejections_in_a_row = 64;

}  // namespace

void FromScratch::refine(const RefinedCuts& refined, const RefineOptions& options, Questions& questions,
                         Occluder& occluder, RefineStats& stats) {
  refined_ = refined;
  options_ = &options;
  questions_ = &questions;
  occluder_mesh_ = &occluder;
  stats_ = &stats;
  begin();
  run();
  end_level_ = queue_.empty() ? 0.0F : queue_.top().priority;
  stats_->level_px = static_cast<double>(end_level_);
  if (options_->queries.final_check) readmit();
  finish();
}

void FromScratch::begin() {
  triangles_ = 0;
  for (Cut& cut : refined_.cuts) {
    cut.clear();
    triangles_ += cut.triangle_count();
  }
  base_triangles_ = triangles_;
  steps_.begin(*options_);
  queue_.clear();
  lookahead_.begin(refined_, *options_);
  hidden_.clear();
  victims_.clear();
  occluder_ = 0;
  rejections_in_a_row_ = 0;
  left_ = {};
  level_.reset();
  for (std::uint32_t i = 0; i < refined_.objects.size(); ++i) meet_roots(i);
}

void FromScratch::meet_roots(std::uint32_t object) {
  const std::span<const SplitId> roots = refined_.cuts[object].hierarchy().data().roots;
  root_scales_px_.resize(roots.size());
  lookahead_.weigh(object, roots, root_scales_px_);
  for (std::size_t i = 0; i < roots.size(); ++i) meet(object, roots[i], root_scales_px_[i], no_id, 0);
}

void FromScratch::finish() {
  stats_->triangles = triangles_;
  stats_->culled_occlusion = hidden_.size();
  queue_.for_each([&](const Entry& entry) {
    if (!refined_.cuts[entry.object].applied(entry.split)) left_.include(entry.error);
  });
  stats_->max_error_px = static_cast<double>(left_.guaranteed_px);
  stats_->max_quadric_error_px = static_cast<double>(left_.quadric_px);
}

void FromScratch::run() {
  while (!used_up()) {
    if (occluder_due()) {
      drain();
      draw_occluder();
    }
    if (questions_->in_flights()) fill_flight();
    const bool anything = !queue_.empty() && matters(queue_.top());
    if (!questions_->none_open() && (!anything || !questions_->has_room()))
      settle();
    else if (anything)
      take_next();
    else
      break;
  }
  drain();
}

// An entry of the queue that matters.
void FromScratch::take_next() {
  if (!questions_->in_flights() && must_ask(queue_.top())) ask_ahead();
  Entry entry = queue_.pop();
  if (entry.is_hidden && entry.asked_occluder == occluder_)
    hide(entry);
  else
    process(entry);
}

bool FromScratch::used_up() const {
  if (rejections_in_a_row_ >= most_rejections_in_a_row) return true;
  if (level_) return questions_->none_open() && (queue_.empty() || !matters(queue_.top()));
  return triangles_ >= options_->budget;
}

// What earlier occluders hid is asked about once more, before the mesh as it is now. What this mesh shows takes the
// place of what matters less.
void FromScratch::readmit() {
  if (occluder_ == 0 || hidden_.empty() || stats_->splits == steps_.last().splits) return;
  level_ = queue_.empty() ? 0.0F : queue_.top().priority;
  rejections_in_a_row_ = 0;
  doubtful_.swap(hidden_);
  draw_occluder();
  ask_about_doubtful();
  stats_->readmitted = doubtful_.size() - hidden_.size();
  doubtful_.clear();
  run();
}

// A node comes into sight of the refinement: dropped for good, or offered.
void FromScratch::meet(std::uint32_t object, SplitId s, float scale_px, SplitId parent, std::uint32_t level) {
  const SplitNode& node = refined_.cuts[object].hierarchy().node(s);
  if (node.parent != parent)  // else a file that lies about its forest could be walked without an end
    throw Error({"hierarchy", "split " + std::to_string(s), "is not where its parent says", "build it again"});
  ++stats_->visits;
  if (scale_px == scale_outside) {
    ++stats_->culled_frustum;
    return;
  }
  if (refined_.gate->tests_cone(object) && refined_.gate->cone_culled(object, scale_px == scale_facing_away)) {
    ++stats_->culled_backface;
    return;
  }
  const ScreenError error(node, scale_px);
  if (is_tolerated(error)) return;
  const auto entry = [&] { return Entry{error.quadric_px, error, s, object, level, 0, Entry::Kind::visit}; };
  if (questions_->in_flights())
    offer(entry());
  else
    queue_.push(entry());  // written where it stays
}

// Small enough to be left as it is, and noted as such.
bool FromScratch::is_tolerated(const ScreenError& error) {
  if (!(options_->tolerance_px > 0.0 && error.guaranteed_px <= static_cast<float>(options_->tolerance_px)))
    return false;
  left_.include(error);
  return true;
}

// An entry that is visible as far as we know.
void FromScratch::process(Entry& entry) {
  if (entry.kind == Entry::Kind::visit) {
    if (!entry.children_weighed) lookahead_.weigh_children(entry, queue_);
    const SplitNode& node = refined_.cuts[entry.object].hierarchy().node(entry.split);
    if (options_->priority.culling == Culling::subtree)
      apply(entry);
    else
      consider(entry);
    const auto [scale_u, scale_v] = entry.child_scales_px;
    if (node.child_u != no_id) meet(entry.object, node.child_u, scale_u, entry.split, entry.level + 1);
    if (node.child_v != no_id) meet(entry.object, node.child_v, scale_v, entry.split, entry.level + 1);
  } else {
    apply(entry);
  }
}

// Culling::star: does the split itself change anything that is seen, and how much of what it changes?
void FromScratch::consider(const Entry& entry) {
  if (refined_.cuts[entry.object].applied(entry.split)) return;
  const Importance::Value value = refined_.importances[entry.object].of(entry.split);
  if (value.visible_share == 0.0F) {
    ++stats_->culled_backface;
    return;
  }
  if (is_tolerated(value.error)) return;
  offer({value.priority, value.error, entry.split, entry.object, entry.level, 0, Entry::Kind::apply});
}

void FromScratch::apply(const Entry& entry) {
  Cut& cut = refined_.cuts[entry.object];
  if (cut.applied(entry.split)) return;
  Cut::Closure closure = cut.closure(entry.split);
  if (waits(entry, closure)) return;
  while (triangles_ + closure.triangles > options_->budget) {
    if (!make_room(entry)) {
      ++stats_->rejected_splits;
      ++rejections_in_a_row_;
      left_.include(entry.error);
      return;
    }
    closure = cut.closure(entry.split);
  }
  rejections_in_a_row_ = 0;
  count_splits(entry, closure);
  triangles_ -= cut.triangle_count();
  cut.apply_closure();
  triangles_ += cut.triangle_count();
}

// Culling::star: a split that forces others which nobody sees steps back in the queue, once.
bool FromScratch::waits(const Entry& entry, const Cut::Closure& closure) {
  if (options_->priority.culling != Culling::star || entry.weighed || closure.splits.size() == 1) return false;
  Entry later = entry;
  later.weighed = true;
  later.priority *= refined_.importances[entry.object].forced_weight(closure.splits);
  if (queue_.would_be_next(later)) return false;
  queue_.push(later);
  return true;
}

// After the final check: gives up the least important leaf, if it matters less than `entry`. It may come back.
bool FromScratch::make_room(const Entry& entry) {
  if (!level_) return false;
  if (!victims_.gathered()) victims_.gather(refined_.cuts, refined_.importances);
  const std::optional<Victims::Victim> victim =
      victims_.take_back_below(entry.priority, refined_.cuts, refined_.importances);
  if (!victim) return false;
  triangles_ -= victim->triangles;
  --stats_->splits;
  ++stats_->taken_back;
  if (victim->priority > 0.0F)
    queue_.push({victim->priority, victim->error, victim->split, victim->object, 0, occluder_, Entry::Kind::apply});
  return true;
}

void FromScratch::count_splits(const Entry& entry, const Cut::Closure& closure) {
  steps_.split_applied(entry.error.quadric_px);
  stats_->splits += closure.splits.size();
  stats_->forced_splits += closure.splits.size() - 1;
  if (options_->priority.culling != Culling::star) return;
  for (const SplitId s : closure.splits.subspan(1))
    if (refined_.importances[entry.object].visible_share(s) == 0.0F) ++stats_->forced_unseen_splits;
}

}  // namespace occlod
