// What a frame asks about occlusion.
#include <algorithm>
#include <optional>

#include "queries/query_shape.h"
#include "refine/frames.h"

namespace occlod {
namespace {

constexpr std::uint32_t most_age = 0xFFFF;  // that a node can tell, in occluders

}  // namespace

// Hidden things that would matter are asked about before the mesh as it is now, in the new view; so is a rotating share
// of what the budget has been spent on, or all of that. What is met for the first time is asked about when its turn
// comes.
void Frames::ask_again(Occluder& occluder, bool all) {
  questions_->draw_occluder(occluder.build(refined_.objects, refined_.cuts, refined_.views, options_->occluder.mode));
  ++stats_->occluder_draws;
  ++draw_;
  asked_.clear();
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    forget_what_is_not_asked(i);
    ask_about_hidden(i);
    if (questions_->in_flights()) ask_about_unapplied(i);
    ask_about_leaves(i, all);
  }
  questions_->ask_all(
      asked_,
      [&](const Entry& entry) {
        return query_about(entry, refined_.cuts[entry.object].hierarchy(), options_->queries.proxy, star_);
      },
      [&](const Entry& entry, bool visible) { note(entry, visible); });
  stats_->queries += asked_.size();
}

// Nothing stays hidden that no question could show again.
void Frames::forget_what_is_not_asked(std::uint32_t object) {
  Front& front = objects_[object].front;
  found_.clear();
  select(errors(object), {.all = Front::hidden}, found_);
  for (const Front::Index k : found_) {
    const bool asks = refined_.gate->asks(object, front.node(k).sphere.center);
    if (!asks) front.set(k, Front::subtree_hidden, false);
    if (!asks || !options_->queries.ask_stars) front.set(k, Front::star_hidden, false);
  }
}

void Frames::ask_about(std::uint32_t object, Front::Index k, Entry::Kind kind) {
  const FrontNode& node = objects_[object].front.node(k);
  if (refined_.gate->asks(object, node.sphere.center))
    asked_.push_back({0.0F, {}, node.split, object, node.level, 0, kind});
}

// What the smallest error of a subtree is that may matter.
float Frames::least_that_matters() const { return level_ / band / most_grazing; }

void Frames::ask_about_hidden(std::uint32_t object) {
  const Front& front = objects_[object].front;
  found_.clear();
  select(errors(object), {.all = Front::hidden, .may_exceed = least_that_matters()}, found_);
  for (const Front::Index k : found_)
    ask_about(object, k, front.is(k, Front::subtree_hidden) ? Entry::Kind::visit : leaf_question());
}

// A backend that likes many questions at once is asked about whatever may come up.
void Frames::ask_about_unapplied(std::uint32_t object) {
  const Front& front = objects_[object].front;
  found_.clear();
  select(errors(object), {.none = Front::applied | Front::hidden, .may_exceed = least_that_matters()}, found_);
  for (const Front::Index k : found_)
    ask_about(object, k, front.is(k, Front::descended) && asks_stars() ? leaf_question() : Entry::Kind::visit);
}

// Whether splits are asked about before and while they are applied.
bool Frames::asks_stars() const {
  return options_->priority.culling == Culling::subtree || options_->queries.ask_stars;
}

// What this view has shown is not asked about again until it moves: it would come and go.
void Frames::ask_about_leaves(std::uint32_t object, bool all) {
  if (!asks_stars()) return;
  const Front& front = objects_[object].front;
  found_.clear();
  select(errors(object), {.all = Front::leaf, .none = Front::hidden, .may_exceed = 0.0F}, found_);
  for (const Front::Index k : found_)
    if ((all || (front.node(k).split + frame_) % asking_rounds == 0) &&
        !is_shown_since(fresh_draw_, front.node(k), leaf_question()))
      ask_about(object, k, leaf_question());
}

Entry::Kind Frames::leaf_question() const {
  return options_->priority.culling == Culling::star ? Entry::Kind::apply : Entry::Kind::visit;
}

// Whether it was found visible before that occluder or a later one.
bool Frames::is_shown_since(std::uint32_t draw, const FrontNode& node, Entry::Kind kind) const {
  if (draw > draw_) return false;
  const std::uint16_t shown = kind == Entry::Kind::visit ? node.subtree_shown : node.star_shown;
  return static_cast<std::uint16_t>(draw_ - shown) <= std::min(draw_ - draw, most_age);
}

void Frames::note(const Entry& entry, bool visible) {
  Front& front = objects_[entry.object].front;
  const Front::Index k = front.find(entry.split);
  const bool subtree = entry.kind == Entry::Kind::visit;
  front.set(k, subtree ? Front::subtree_hidden : Front::star_hidden, !visible);
  FrontNode& node = front.node(k);
  if (visible) (subtree ? node.subtree_shown : node.star_shown) = static_cast<std::uint16_t>(draw_);
  if (!visible) ++stats_->queries_hidden;
  refined_.gate->answered(entry.object, entry.kind, node.sphere.center, front.error_at_most(k).quadric_px, visible);
}

void Frames::forget_hidden() {
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    Front& front = objects_[i].front;
    found_.clear();
    select(errors(i), {.all = Front::hidden}, found_);
    for (const Front::Index k : found_) {
      front.set(k, Front::subtree_hidden, false);
      front.set(k, Front::star_hidden, false);
    }
  }
}

// Whether the occluder of this frame hides it: asked now, unless it has been.
bool Frames::is_hidden(const Entry& entry) {
  if (!questions_->can_hide() || stats_->occluder_draws == 0) return false;
  const bool subtree = entry.kind == Entry::Kind::visit;
  if (!subtree && (options_->priority.culling == Culling::subtree || !options_->queries.ask_stars)) return false;
  if (subtree && entry.level % options_->queries.level_step != options_->queries.level_step - 1) return false;
  const Front& front = objects_[entry.object].front;
  const FrontNode& node = front.node(front.find(entry.split));
  if (!refined_.gate->asks(entry.object, node.sphere.center)) return false;
  if (questions_->in_flights()) return false;  // it would be waited for: asked about before the next frame
  if (is_shown_since(draw_, node, entry.kind)) return false;
  questions_->ask(entry, query_about(entry, refined_.cuts[entry.object].hierarchy(), options_->queries.proxy, star_));
  ++stats_->queries;
  const bool visible = questions_->take().visible;
  note(entry, visible);
  return !visible;
}

}  // namespace occlod
