#include <algorithm>

#include "refine/frames.h"
#include "refine/refined_scene.h"
#include "refine/tuning.h"

namespace occlod {

void FrontForest::adopt_splits(std::uint32_t object) {
  Front& front = evaluation_.front(object);
  const Cut& cut = (*evaluation_.scene().cuts)[object];
  for (const SplitId s : cut.applied_splits()) {
    if (!cut.applied(s)) continue;
    const Front::Index k = front.obtain(s);
    front.set(k, Front::applied, true);
    front.set(k, Front::leaf, cut.is_leaf(s));
  }
}

void FrontForest::adopt_forest(std::uint32_t object, float level) {
  Front& front = evaluation_.front(object);
  const std::span<const SplitId> roots = evaluation_.scene().hierarchy(object).data().roots;
  reached_.clear();
  for (const SplitId root : roots) reach(object, root, no_id, 0);
  open_.assign(roots.begin(), roots.end());
  while (!open_.empty()) {  // descends level by level
    evaluation_.evaluate(object, reached_);
    reached_.clear();
    level_.swap(open_);
    open_.clear();
    for (const SplitId s : level_) {
      const Front::Index k = front.find(s);
      if (front.is(k, Front::subtree_hidden) || !(front.error_at_most(k).quadric_px > level)) continue;
      const std::size_t before = reached_.size();
      reach_children(object, s);
      for (std::size_t i = before; i < reached_.size(); ++i) open_.push_back(front.node(reached_[i]).split);
    }
  }
  for (std::size_t k = front.size(); k-- > 0;) {
    const auto at = static_cast<Front::Index>(k);
    if (!front.is(at, Front::reached) && !front.is(at, Front::applied)) front.remove(at);
  }
  evaluation_.evaluate_expired(object);  // evaluates applied nodes that were not reached
}

std::span<const Front::Index> FrontForest::descend(std::uint32_t object, std::span<const SplitId> splits) {
  reached_.clear();
  for (const SplitId s : splits) reach_children(object, s);
  evaluation_.evaluate(object, reached_);
  return reached_;
}

// Adds a node to the front. What it is worth is not known yet.
void FrontForest::reach(std::uint32_t object, SplitId s, SplitId parent, std::uint16_t level) {
  const Hierarchy& hierarchy = evaluation_.scene().hierarchy(object);
  hierarchy.require(s);
  require_parent(hierarchy, s, parent);
  Front& front = evaluation_.front(object);
  const Front::Index k = front.obtain(s);
  front.set(k, Front::reached, true);
  front.node(k).level = level;
  reached_.push_back(k);
}

void FrontForest::reach_children(std::uint32_t object, SplitId s) {
  Front& front = evaluation_.front(object);
  const Front::Index k = front.find(s);
  front.set(k, Front::descended, true);
  const SplitNode& split = evaluation_.scene().hierarchy(object).node(s);
  for (const SplitId child : {split.child_u, split.child_v})
    if (child != no_id) reach(object, child, s, FrontNode::below(front.node(k).level));
}

void FrontForest::close(std::uint32_t object, float least) {
  Front& front = evaluation_.front(object);
  const Hierarchy& hierarchy = evaluation_.scene().hierarchy(object);
  found_.clear();
  const BoundedProducts of = evaluation_.errors(object);
  select(of, {.all = Front::descended | Front::subtree_hidden}, found_);
  select(of, {.all = Front::descended, .none = Front::subtree_hidden, .may_be_below = least}, found_);
  open_.clear();
  for (const Front::Index k : found_) open_.push_back(front.node(k).split);
  for (const SplitId first : open_)
    for (SplitId s = first; s != no_id && close_one(object, s, least);) s = hierarchy.node(s).parent;
}

bool FrontForest::is_closable(const Front& front, Front::Index k, float least) const {
  return front.is(k, Front::subtree_hidden) ||
         front.scales().error_factor[k] * front.error_at_most(k).quadric_px <= least;
}

bool FrontForest::close_one(std::uint32_t object, SplitId s, float least) {
  Front& front = evaluation_.front(object);
  const Front::Index k = front.find(s);
  if (k == Front::none || !front.is(k, Front::descended) || !is_closable(front, k, least)) return false;
  const SplitNode& split = evaluation_.scene().hierarchy(object).node(s);
  for (const SplitId child : {split.child_u, split.child_v})
    if (child != no_id && front.is(front.find(child), Front::descended)) return false;
  front.set(k, Front::descended, false);
  for (const SplitId child : {split.child_u, split.child_v}) {
    if (child == no_id) continue;
    const Front::Index below = front.find(child);
    front.set(below, Front::reached, false);
    if (!front.is(below, Front::applied)) front.remove(below);
  }
  return true;
}

namespace {

constexpr std::uint32_t max_age = 0xFFFF;  // largest age that a node can tell, in occluders

}  // namespace

void FrontQueries::adopt(std::span<const Entry> hidden) {
  adopted_draw_ = draw_;
  for (const Entry& entry : hidden) {
    Front& front = evaluation_.front(entry.object);
    front.set(front.obtain(entry.split), entry.kind == Entry::Kind::visit ? Front::subtree_hidden : Front::star_hidden,
              true);
  }
}

void FrontQueries::begin_frame(std::uint32_t frame, bool moved) {
  frame_ = frame;
  if (moved) fresh_draw_ = draw_ + 1;
}

std::size_t FrontQueries::ask_again(float level) {
  begin_questions();
  const float least = min_error(level);
  for (std::uint32_t i = 0; i < evaluation_.object_count(); ++i) {
    forget_what_is_not_asked(i);
    ask_about_hidden(i, least);
    if (evaluation_.scene().queries->in_flights()) ask_about_unapplied(i, least);
    ask_about_leaves(i);
  }
  ask_all();
  return asked_.size();
}

std::span<const Entry> FrontQueries::check_hidden(float least) {
  begin_questions();
  for (std::uint32_t i = 0; i < evaluation_.object_count(); ++i) ask_about_hidden(i, least);
  ask_all();
  return asked_;
}

// Begins questions to the picture of the frame before or, where there is none, to an occluder that is drawn now.
void FrontQueries::begin_questions() {
  OcclusionQueries& queries = *evaluation_.scene().queries;
  if (!queries.from_picture()) queries.draw_occluder(*evaluation_.scene().cuts);
  ++draw_;
  asked_.clear();
}

// Returns the smallest error in pixels of a subtree that may matter.
float FrontQueries::min_error(float level) const { return level / level_band / evaluation_.most_grazing(); }

void FrontQueries::ask_all() {
  verdicts_.resize(asked_.size());
  evaluation_.scene().queries->ask(asked_, verdicts_);
  std::size_t shown = 0;
  for (std::size_t i = 0; i < asked_.size(); ++i)
    if (note(asked_[i], verdicts_[i])) asked_[shown++] = asked_[i];
  asked_.resize(shown);
}

// Unmarks hidden and covered nodes that no question could show again.
void FrontQueries::forget_what_is_not_asked(std::uint32_t object) {
  const OcclusionQueries& queries = *evaluation_.scene().queries;
  if (queries.asks_everywhere(object) && queries.asks_stars()) return;
  Front& front = evaluation_.front(object);
  found_.clear();
  select(evaluation_.errors(object), {.all = Front::hidden}, found_);
  select(evaluation_.errors(object), {.all = Front::covered, .none = Front::hidden}, found_);
  for (const Front::Index k : found_) {
    const bool asks = queries.asks_in_region(object, front.node(k).split);
    if (!asks) front.set(k, Front::subtree_hidden, false);
    if (asks && queries.asks_stars()) continue;
    front.set(k, Front::star_hidden, false);
    set_covered(front, k, false);
  }
}

void FrontQueries::ask_about(std::uint32_t object, Front::Index k, Entry::Kind kind) {
  const Front& front = evaluation_.front(object);
  const FrontNode& node = front.node(k);
  if (evaluation_.scene().queries->asks_in_region(object, node.split))
    asked_.push_back({0.0F, front.error_at_most(k), node.split, object, node.level, 0, kind});
}

// Asks about hidden nodes whose errors in this view exceed `least`.
void FrontQueries::ask_about_hidden(std::uint32_t object, float least) {
  const Front& front = evaluation_.front(object);
  const Entry::Kind about_splits = evaluation_.scene().queries->split_question();
  found_.clear();
  select(evaluation_.errors(object), {.all = Front::hidden, .may_exceed = least}, found_);
  evaluation_.evaluate(object, found_);
  for (const Front::Index k : found_)
    if (front.error_at_most(k).quadric_px > least)
      ask_about(object, k, front.is(k, Front::subtree_hidden) ? Entry::Kind::visit : about_splits);
}

// Asks a backend that prefers many questions at once about everything that may come up.
void FrontQueries::ask_about_unapplied(std::uint32_t object, float least) {
  const OcclusionQueries& queries = *evaluation_.scene().queries;
  const Front& front = evaluation_.front(object);
  found_.clear();
  select(evaluation_.errors(object), {.none = Front::applied | Front::hidden, .may_exceed = least}, found_);
  for (const Front::Index k : found_)
    ask_about(object, k,
              front.is(k, Front::descended) && queries.asks_splits() ? queries.split_question() : Entry::Kind::visit);
}

// Asks about a part of the leaves. What this view has shown is not asked about again until it moves, or it would come
// and go.
void FrontQueries::ask_about_leaves(std::uint32_t object) {
  const OcclusionQueries& queries = *evaluation_.scene().queries;
  if (!queries.asks_splits()) return;
  const Front& front = evaluation_.front(object);
  found_.clear();
  select(evaluation_.errors(object), {.all = Front::leaf, .none = Front::hidden, .may_exceed = 0.0F}, found_);
  for (const Front::Index k : found_)
    if ((front.node(k).split + frame_) % asking_rounds == 0 &&
        !is_shown_since(fresh_draw_, front.node(k), queries.split_question()))
      ask_about(object, k, queries.split_question());
}

// Returns whether the node was found visible with occluder `draw` or a later one.
bool FrontQueries::is_shown_since(std::uint32_t draw, const FrontNode& node, Entry::Kind kind) const {
  if (draw > draw_) return false;
  const std::uint16_t shown = kind == Entry::Kind::visit ? node.subtree_shown : node.star_shown;
  return static_cast<std::uint16_t>(draw_ - shown) <= std::min(draw_ - draw, max_age);
}

// Keeps the node's weight in step, until it is weighed again.
void FrontQueries::set_covered(Front& front, Front::Index k, bool covered) const {
  if (covered == front.is(k, Front::covered)) return;
  const RefineOptions* const options = evaluation_.scene().options;
  const auto factor = static_cast<float>(tuning_of(*options).covered_factor);
  front.set(k, Front::covered, covered);
  front.forced_weight(k) *= covered ? factor : 1.0F / factor;
}

// Records an answer. Returns true when the node was hidden and is no longer.
bool FrontQueries::note(const Entry& entry, const OcclusionQueries::Verdict& verdict) {
  Front& front = evaluation_.front(entry.object);
  const Front::Index k = front.find(entry.split);
  const bool subtree = entry.kind == Entry::Kind::visit;
  const Front::Flag hidden = subtree ? Front::subtree_hidden : Front::star_hidden;
  const bool visible = verdict.visible, shown_again = visible && front.is(k, hidden);
  front.set(k, hidden, !visible);
  if (!subtree) set_covered(front, k, verdict.covered);
  FrontNode& node = front.node(k);
  if (visible) (subtree ? node.subtree_shown : node.star_shown) = static_cast<std::uint16_t>(draw_);
  return shown_again;
}

void FrontQueries::forget_hidden() {
  for (std::uint32_t i = 0; i < evaluation_.object_count(); ++i) {
    Front& front = evaluation_.front(i);
    found_.clear();
    select(evaluation_.errors(i), {.all = Front::hidden}, found_);
    for (const Front::Index k : found_) {
      front.set(k, Front::subtree_hidden, false);
      front.set(k, Front::star_hidden, false);
    }
    found_.clear();
    select(evaluation_.errors(i), {.all = Front::covered}, found_);
    for (const Front::Index k : found_) set_covered(front, k, false);
  }
}

// Asks about entries that this occluder has not shown. Returns false where nothing can be asked now: a backend whose
// answers would be waited for is asked in the next frame.
bool FrontQueries::ask_unless_asked(std::span<const Entry> entries) {
  const OcclusionQueries& queries = *evaluation_.scene().queries;
  if (!queries.can_hide() || !queries.has_occluder() || queries.in_flights()) return false;
  asked_.clear();
  for (const Entry& entry : entries) {
    const Front& front = evaluation_.front(entry.object);
    if (queries.asks(entry) && !is_shown_since(draw_, front.node(front.find(entry.split)), entry.kind))
      asked_.push_back(entry);
  }
  if (!asked_.empty()) ask_all();
  return true;
}

void FrontQueries::drop_hidden(std::vector<Entry>& entries) {
  if (!ask_unless_asked(entries)) return;
  std::erase_if(entries, [&](const Entry& entry) {
    const Front& front = evaluation_.front(entry.object);
    return front.is(front.find(entry.split),
                    entry.kind == Entry::Kind::visit ? Front::subtree_hidden : Front::star_hidden);
  });
}

void FrontQueries::ask_about_new_leaf(std::uint32_t object, Front::Index k) {
  const Front& front = evaluation_.front(object);
  const FrontNode& node = front.node(k);
  const Entry::Kind kind = evaluation_.scene().queries->split_question();
  if (is_shown_since(fresh_draw_, node, kind)) return;
  const Entry entry{0.0F, front.error_at_most(k), node.split, object, node.level, 0, kind};
  static_cast<void>(ask_unless_asked({&entry, 1}));
}

// Nodes keep the low bits of the numbers of the occluders that showed them, so ages are right up to 65,535 occluders
// and begin at 0 again beyond them. The bounds of a subtree contain those of all splits below: what shows a split shows
// its ancestors, and ids rise along the forest.
std::vector<std::uint32_t> FrontQueries::visibility_ages(std::uint32_t object, std::span<const SplitId> splits) const {
  const std::uint32_t since_adopted = draw_ - adopted_draw_;
  std::vector<std::uint32_t> ages(splits.size(), since_adopted == 0 ? 0 : never_asked);
  const auto since = [&](std::uint16_t shown) -> std::uint32_t { return static_cast<std::uint16_t>(draw_ - shown); };
  const Hierarchy& hierarchy = evaluation_.scene().hierarchy(object);
  const Front& front = evaluation_.front(object);
  for (std::size_t i = splits.size(); i-- > 0;) {
    if (const Front::Index k = front.find(splits[i]); k != Front::none) {
      const std::uint32_t age = std::min(since(front.node(k).subtree_shown), since(front.node(k).star_shown));
      if (age < since_adopted) ages[i] = std::min(ages[i], age);
    }
    const auto parent = std::lower_bound(splits.begin(), splits.end(), hierarchy.node(splits[i]).parent);
    if (parent == splits.end() || *parent != hierarchy.node(splits[i]).parent) continue;
    std::uint32_t& age = ages[static_cast<std::size_t>(parent - splits.begin())];
    age = std::min(age, ages[i]);
  }
  return ages;
}

}  // namespace occlod
