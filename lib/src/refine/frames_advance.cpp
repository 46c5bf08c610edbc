#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "frames.h"
#include "query_shape.h"

namespace occlod {
namespace {

// Of what is held to be visible, one in so many is asked about again in each frame.
constexpr std::size_t asking_rounds = 8;
constexpr std::uint32_t most_age = 0xFFFF;  // that a node can tell, in occluders
// More changes than this part of the nodes of the front.
constexpr double much_change = 0.02;
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
  if (can_hide && moved && options_->final_check && has_changed_much()) {
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
  stats.culled_frustum = unseen_.outside;
  stats.culled_backface = unseen_.facing_away;
  stats.level_px = static_cast<double>(level_);
  stats.max_error_px = static_cast<double>(left_.guaranteed_px);
  stats.max_quadric_error_px = static_cast<double>(left_.quadric_px);
}

// Hidden things that would matter are asked about before the mesh as it is now, in the new view; so is a rotating share
// of what the budget has been spent on, or all of that. What is met for the first time is asked about when its turn
// comes.
void Frames::ask_again(Occluder& occluder, bool all) {
  questions_->draw_occluder(occluder.build(refined_.objects, refined_.cuts, refined_.views, options_->occluder_mode));
  ++stats_->occluder_draws;
  ++draw_;
  asked_.clear();
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const std::span<FrontNode> nodes = objects_[i].front.nodes();
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      forget_what_is_not_asked(i, nodes[k]);
      const bool due = all || (k + frame_) % asking_rounds == 0;
      if (const std::optional<Entry::Kind> kind = question_about(i, nodes[k], due))
        asked_.push_back({0.0F, {}, nodes[k].split, i, nodes[k].level, 0, *kind});
    }
  }
  questions_->ask_all(
      asked_,
      [&](const Entry& entry) {
        return query_about(entry, refined_.cuts[entry.object].hierarchy(), options_->proxy, star_);
      },
      [&](const Entry& entry, bool visible) { note(entry, visible); });
  stats_->queries += asked_.size();
}

// Nothing stays hidden that no question could show again.
void Frames::forget_what_is_not_asked(std::uint32_t object, FrontNode& node) const {
  const bool asks = refined_.gate->asks(object, node.sphere.center);
  if (!asks) node.set(FrontNode::subtree_hidden, false);
  if (!asks || !options_->ask_stars) node.set(FrontNode::star_hidden, false);
}

// What has to be asked about a node, if anything. `due`: also about what was visible.
std::optional<Entry::Kind> Frames::question_about(std::uint32_t object, const FrontNode& node, bool due) const {
  const float bound = node.quadric_px();
  if (!(bound > 0.0F) || !refined_.gate->asks(object, node.sphere.center)) return std::nullopt;
  const bool would_matter = bound * most_grazing > level_ / band;
  if (node.is(FrontNode::subtree_hidden)) return would_matter ? std::optional(Entry::Kind::visit) : std::nullopt;
  const Entry::Kind kind = leaf_question(object, node).kind;
  const bool asks_stars = kind == Entry::Kind::visit || options_->ask_stars;
  if (node.is(FrontNode::star_hidden)) return would_matter ? std::optional(kind) : std::nullopt;
  if (questions_->in_flights() && would_matter && !node.is(FrontNode::applied))
    return node.is(FrontNode::descended) && asks_stars ? kind : Entry::Kind::visit;
  // What this view has shown is not asked about again until it moves: it would come and go.
  if (due && asks_stars && node.is(FrontNode::applied) && !is_shown_since(fresh_draw_, node, kind) &&
      refined_.cuts[object].is_leaf(node.split))
    return kind;
  return std::nullopt;
}

// Whether it was found visible before that occluder or a later one.
bool Frames::is_shown_since(std::uint32_t draw, const FrontNode& node, Entry::Kind kind) const {
  if (draw > draw_) return false;
  const std::uint16_t shown = kind == Entry::Kind::visit ? node.subtree_shown : node.star_shown;
  return static_cast<std::uint16_t>(draw_ - shown) <= std::min(draw_ - draw, most_age);
}

void Frames::note(const Entry& entry, bool visible) {
  FrontNode& node = *objects_[entry.object].front.find(entry.split);
  const bool subtree = entry.kind == Entry::Kind::visit;
  node.set(subtree ? FrontNode::subtree_hidden : FrontNode::star_hidden, !visible);
  if (visible) (subtree ? node.subtree_shown : node.star_shown) = static_cast<std::uint16_t>(draw_);
  if (!visible) ++stats_->queries_hidden;
  refined_.gate->answered(entry.object, entry.kind, node.sphere.center, node.quadric_px(), visible);
}

void Frames::forget_hidden() {
  for (Object& object : objects_)
    for (FrontNode& node : object.front.nodes()) {
      node.set(FrontNode::subtree_hidden, false);
      node.set(FrontNode::star_hidden, false);
    }
}

// Whether the occluder of this frame hides it: asked now, unless it has been.
bool Frames::is_hidden(const Entry& entry) {
  if (!questions_->can_hide() || stats_->occluder_draws == 0) return false;
  const bool subtree = entry.kind == Entry::Kind::visit;
  if (!subtree && (options_->culling == Culling::subtree || !options_->ask_stars)) return false;
  if (subtree && entry.level % options_->level_step != options_->level_step - 1) return false;
  const FrontNode& node = *objects_[entry.object].front.find(entry.split);
  if (!refined_.gate->asks(entry.object, node.sphere.center)) return false;
  if (questions_->in_flights()) return false;  // it would be waited for: asked about before the next frame
  if (is_shown_since(draw_, node, entry.kind)) return false;
  questions_->ask(entry, query_about(entry, refined_.cuts[entry.object].hierarchy(), options_->proxy, star_));
  ++stats_->queries;
  const bool visible = questions_->take().visible;
  note(entry, visible);
  return !visible;
}

// So much that the mesh which hid things in this frame is not the one that is handed over.
bool Frames::has_changed_much() const {
  std::size_t nodes = 0;
  for (const Object& object : objects_) nodes += object.front.nodes().size();
  return static_cast<double>(changes_) > much_change * static_cast<double>(nodes);
}

// Splits of this frame may be taken back too, once a better occluder is there.
void Frames::let_new_ones_go() {
  for (Object& object : objects_)
    for (FrontNode& node : object.front.nodes()) node.set(FrontNode::is_new, false);
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
    const Entry entry = candidates_.pop();
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
  if (options_->most_changes > 0 && changes_ >= options_->most_changes) return true;
  return options_->time_limit_ms > 0.0 && milliseconds_since(start_) >= options_->time_limit_ms;
}

void Frames::descend(const Entry& entry) {
  const std::uint32_t i = entry.object;
  descend_from(i, entry.split, [&](SplitId child) {
    const FrontNode& node = *objects_[i].front.find(child);
    const ScreenError error(node.error, node.guaranteed_error, node.scale_px);
    if (error.quadric_px > 0.0F && !node.is(FrontNode::subtree_hidden) && !is_tolerated(error))
      candidates_.push({error.quadric_px, error, child, i, node.level, 0, Entry::Kind::visit});
  });
  FrontNode& node = *objects_[i].front.find(entry.split);
  if (!node.is(FrontNode::applied)) offer(i, node);
}

// The split of a node that is reached, if it is worth anything.
void Frames::offer(std::uint32_t i, FrontNode& node) {
  const Worth value = worth(i, node);
  if (value.raw > 0.0F && !is_tolerated(value.error))
    candidates_.push({value.raw, value.error, node.split, i, node.level, 0, Entry::Kind::apply});
}

// False when there is no room for it.
bool Frames::apply(const Entry& entry) {
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
bool Frames::waits(const Entry& entry, const Cut::Closure& closure) {
  if (options_->culling != Culling::star || entry.weighed) return false;
  FrontNode& node = *objects_[entry.object].front.find(entry.split);
  node.forced_weight =
      closure.splits.size() == 1 ? 1.0F : refined_.importances[entry.object].forced_weight(closure.splits);
  Entry later = entry;
  later.weighed = true;
  later.priority *= node.forced_weight;
  if (node.forced_weight == 1.0F || candidates_.would_be_next(later)) return false;
  candidates_.push(later);
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
    FrontNode* node = object.front.find(s);
    if (node == nullptr) {
      node = &object.front.obtain(s);
      node->scale_px = scale_px_of(*node, refined_.views[i], refined_.gate->tests_cone(i), unseen_);
    }
    node->set(FrontNode::applied, true);
    node->set(FrontNode::is_new, true);
    object.born.push_back(s);
  }
  changes_ += sorted_.size();
}

// Gives up the least important leaf, if that is worth it for what matters `key`.
bool Frames::make_room(float key) {
  if (leaves_.empty() && !gather_more_leaves()) return false;
  const Entry leaf = leaves_.top();
  if (!(1.0F / leaf.priority < key * (1.0F - static_cast<float>(options_->hysteresis)))) return false;
  return take_back_least();
}

// Still what it was when it was queued.
bool Frames::is_old_leaf(const Entry& leaf) {
  const Cut& cut = refined_.cuts[leaf.object];
  return cut.applied(leaf.split) && cut.is_leaf(leaf.split) &&
         !objects_[leaf.object].front.find(leaf.split)->is(FrontNode::is_new);
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
  FrontNode& node = *object.front.find(s);
  node.set(FrontNode::applied, false);
  node.set(FrontNode::is_new, false);
  if (node.is(FrontNode::reached))
    offer(i, node);  // it may be wanted again once better leaves have come up
  else
    object.front.remove(node);
  for (const SplitId needed : cut.hierarchy().star(s).dependencies()) {
    FrontNode& below = *object.front.find(needed);
    if (!cut.is_leaf(needed) || below.is(FrontNode::is_new)) continue;
    // It may well be hidden too, and then its room is wanted now.
    if (asks_leaves_) static_cast<void>(is_hidden(leaf_question(i, below)));
    const float key = leaf_key(i, below);
    if (key < leaves_below_) push_leaf(i, needed, key);
  }
}

Entry Frames::leaf_question(std::uint32_t i, const FrontNode& node) const {
  const Entry::Kind kind = options_->culling == Culling::star ? Entry::Kind::apply : Entry::Kind::visit;
  return {0.0F, {}, node.split, i, node.level, 0, kind};
}

// Where a tolerance is given: leaves that are seen by nobody, or well within it.
void Frames::take_back_needless() {
  if (!(options_->tolerance_px > 0.0) || stats_->pending) return;
  while (!limit_reached() && !leaves_.empty() && std::isinf(leaves_.top().priority)) {
    const Entry leaf = leaves_.pop();
    if (is_old_leaf(leaf)) take_back(leaf.object, leaf.split);
  }
}

void Frames::emit(std::uint32_t i, RefinedObject& out, RefineStats& stats) {
  Object& object = objects_[i];
  object.faces.changes(out.changes);
  const std::vector<Triangle>& triangles = object.faces.triangles();
  out.triangles.resize(triangles.size());
  for (const TriangleRange& range : out.changes) {
    std::copy_n(triangles.begin() + range.first, range.count, out.triangles.begin() + range.first);
    stats.changed_triangles += range.count;
  }
  emit_splits(object, refined_.cuts[i], out, stats);
  emit_geomorphs(object, refined_.cuts[i], out.geomorphs);
  at_rest_ = at_rest_ && out.geomorphs.empty();
}

void Frames::emit_splits(Object& object, const Cut& cut, RefinedObject& out, RefineStats& stats) {
  if (adopted_) {
    stats.merged_splits += out.splits.size();
    out.splits.clear();
    for (const FrontNode& node : object.front.nodes())
      if (node.is(FrontNode::applied)) out.splits.push_back(node.split);
    std::sort(out.splits.begin(), out.splits.end());
    stats.new_splits += out.splits.size();
    return;
  }
  // What came and went, or went and came, is no change.
  const auto settle = [&](std::vector<SplitId>& splits, bool applied) {
    std::sort(splits.begin(), splits.end());
    splits.erase(std::unique(splits.begin(), splits.end()), splits.end());
    std::erase_if(splits, [&](SplitId s) {
      return cut.applied(s) != applied || std::binary_search(out.splits.begin(), out.splits.end(), s) == applied;
    });
  };
  for (const SplitId s : object.born)
    if (FrontNode* const node = object.front.find(s)) node->set(FrontNode::is_new, false);
  settle(object.born, true);
  settle(object.died, false);
  stats.new_splits += object.born.size();
  stats.merged_splits += object.died.size();
  if (object.born.empty() && object.died.empty()) return;
  sorted_.clear();
  std::set_difference(out.splits.begin(), out.splits.end(), object.died.begin(), object.died.end(),
                      std::back_inserter(sorted_));
  out.splits.clear();
  std::merge(sorted_.begin(), sorted_.end(), object.born.begin(), object.born.end(), std::back_inserter(out.splits));
}

void Frames::emit_geomorphs(Object& object, const Cut& cut, std::vector<Geomorph>& out) const {
  out.clear();
  const std::uint32_t frames = options_->geomorph_frames;
  if (frames > 0 && !adopted_)
    for (const SplitId s : object.born) object.morphs.emplace_back(s, frame_);
  std::erase_if(object.morphs,
                [&](const auto& morph) { return !cut.applied(morph.first) || frame_ - morph.second >= frames; });
  for (const auto& [s, born] : object.morphs)
    out.push_back({cut.hierarchy().vertex_of(s), cut.hierarchy().star(s).parent_vertex(),
                   static_cast<float>(frame_ - born + 1) / static_cast<float>(frames + 1)});
}

}  // namespace occlod
