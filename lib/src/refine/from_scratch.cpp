#include "refine/from_scratch.h"

#include "priority/weigh_splits.h"
#include "refine/forest.h"

namespace occlod {
namespace {

// When so many visible splits in a row need more triangles than are left, the budget counts as used up.
constexpr std::size_t most_rejections_in_a_row = 64;

std::uint64_t key_of(std::uint32_t object, SplitId s) { return std::uint64_t{object} << 32U | s; }

}  // namespace

void FromScratch::refine(const RefinedScene& scene, RefineStats& stats) {
  scene_ = scene;
  stats_ = &stats;
  begin();
  run();
  end_level_ = queue_.empty() ? 0.0F : queue_.top().priority;
  const RefineOptions* const options = scene_.options;
  if (options->queries.final_check) readmit();
  finish();
}

void FromScratch::begin() {
  scene_.cuts->clear();
  queue_.clear();
  entries_.begin(scene_);
  lookahead_.begin(scene_);
  victims_.clear();
  forced_.clear();
  taken_back_.clear();
  rejections_in_a_row_ = 0;
  left_ = {};
  level_.reset();
  for (std::uint32_t i = 0; i < scene_.objects.size(); ++i) enqueue_roots(i);
}

void FromScratch::run() {
  const auto matters = [&](const Entry& entry) { return this->matters(entry); };
  while (!used_up()) {
    if (occluder_due()) {
      entries_.drain(queue_);
      entries_.draw_occluder(queue_, growth());
    }
    entries_.fill_flight(queue_, matters);
    const bool anything = !queue_.empty() && matters(queue_.top());
    if (!scene_.queries->none_open() && (!anything || !scene_.queries->has_room()))
      process_answer();
    else if (anything)
      take_next();
    else
      break;
  }
  entries_.drain(queue_);
}

// An entry of the queue that matters.
void FromScratch::take_next() {
  entries_.ask_ahead(queue_, [&](const Entry& entry) { return matters(entry); });
  Entry entry = queue_.pop();
  if (entries_.is_known_hidden(entry))
    entries_.hide(entry);
  else
    process(entry);
}

// The oldest; what is visible is processed if its turn is still now.
void FromScratch::process_answer() {
  std::optional<Entry> entry = entries_.take_answer();
  if (!entry) return;
  if (matters(*entry) && queue_.would_be_next(*entry))
    process(*entry);
  else
    queue_.push(*entry);
}

// An entry that is visible as far as we know.
void FromScratch::process(Entry& entry) {
  if (entry.kind == Entry::Kind::apply) {
    apply(entry);
    return;
  }
  if (!entry.children_weighed) lookahead_.weigh_children(entry, queue_);
  const SplitNode& node = scene_.hierarchy(entry.object).node(entry.split);
  const RefineOptions* const options = scene_.options;
  if (options->priority.culling == Culling::subtree)
    apply(entry);
  else
    enqueue_split(entry);
  const auto [scale_u, scale_v] = entry.child_scales_px;
  if (node.child_u != no_id) enqueue_node(entry, node.child_u, scale_u);
  if (node.child_v != no_id) enqueue_node(entry, node.child_v, scale_v);
}

bool FromScratch::used_up() const {
  if (rejections_in_a_row_ >= most_rejections_in_a_row) return true;
  if (level_) return scene_.queries->none_open() && (queue_.empty() || !matters(queue_.top()));
  return scene_.cuts->triangle_count() >= scene_.options->budget;
}

// What earlier occluders hid is asked about once more, before the mesh as it is now. What this mesh shows takes the
// place of what matters less.
void FromScratch::readmit() {
  if (entries_.occluder() == 0 || hidden().empty() || stats_->splits == entries_.steps().last().splits) return;
  level_ = queue_.empty() ? 0.0F : queue_.top().priority;
  rejections_in_a_row_ = 0;
  stats_->readmitted = entries_.ask_again_about_hidden(queue_, growth());
  run();
}

void FromScratch::finish() {
  count_forced();
  stats_->nodes = stats_->visits;
  stats_->triangles = scene_.cuts->triangle_count();
  stats_->culled_occlusion = hidden().size();
  queue_.for_each([&](const Entry& entry) {
    if (!(*scene_.cuts)[entry.object].applied(entry.split)) left_.include(entry.error);
  });
  stats_->level_px = static_cast<double>(end_level_);
  stats_->max_error_px = static_cast<double>(left_.guaranteed_px);
  stats_->max_quadric_error_px = static_cast<double>(left_.quadric_px);
}

// Of the splits that are still applied.
void FromScratch::count_forced() {
  for (std::size_t i = 0; i < forced_.size(); ++i) {
    const auto back = taken_back_.find(key_of(forced_[i].object, forced_[i].split));
    if (back != taken_back_.end() && i < back->second) continue;
    ++stats_->forced_splits;
    if (forced_[i].unseen) ++stats_->forced_unseen_splits;
  }
}

void FromScratch::enqueue_roots(std::uint32_t object) {
  const std::span<const SplitId> roots = scene_.hierarchy(object).data().roots;
  root_scales_px_.resize(roots.size());
  lookahead_.weigh(object, roots, root_scales_px_);
  const Entry above_roots{0.0F, {}, no_id, object, no_id};
  for (std::size_t i = 0; i < roots.size(); ++i) enqueue_node(above_roots, roots[i], root_scales_px_[i]);
}

// A node comes into sight of the refinement: dropped for good, or enqueued.
void FromScratch::enqueue_node(const Entry& parent, SplitId s, float scale_px) {
  const std::uint32_t object = parent.object;
  require_parent(scene_.hierarchy(object), s, parent.split);
  ++stats_->visits;
  if (scale_px == scale_outside) {
    ++stats_->culled_frustum;
    return;
  }
  if (scene_.gate->tests_cone(object) && scene_.gate->cone_culled(object, scale_px == scale_facing_away)) {
    ++stats_->culled_backface;
    return;
  }
  const ScreenError error(scene_.hierarchy(object).node(s), scale_px);
  if (leaves(error)) return;
  enqueue({error.quadric_px, error, s, object, parent.level + 1, 0, Entry::Kind::visit});
}

// Culling::star: does the split itself change anything that is seen, and how much of what it changes?
void FromScratch::enqueue_split(const Entry& node) {
  if ((*scene_.cuts)[node.object].applied(node.split)) return;
  const Importance::Value value = scene_.importances[node.object].of(node.split);
  if (value.visible_share == 0.0F) {
    ++stats_->culled_backface;
    return;
  }
  if (leaves(value.error)) return;
  enqueue({value.priority, value.error, node.split, node.object, node.level, 0, Entry::Kind::apply});
}

// Into the flight if it has room for a question that must be asked, else into the queue.
void FromScratch::enqueue(const Entry& entry) {
  if (entries_.has_seat_for(entry) && matters(entry))
    entries_.ask(entry);
  else
    queue_.push(entry);
}

// Whether it is small enough to be left as it is; if so, it is counted as such.
bool FromScratch::leaves(const ScreenError& error) {
  if (!error.is_within(scene_.options->tolerance_px)) return false;
  left_.include(error);
  return true;
}

void FromScratch::apply(Entry entry) {
  if (apply_split(scene_, queue_, entry, *this)) return;
  ++stats_->rejected_splits;
  ++rejections_in_a_row_;
  left_.include(entry.error);
}

float FromScratch::forced_weight(const Entry& entry, const Cut::Closure& closure) const {
  return closure.splits.size() == 1 ? 1.0F : scene_.importances[entry.object].forced_weight(closure.splits);
}

// After the final check: gives up the least important leaf, if it matters less. It may come back.
bool FromScratch::make_room(float turn_priority, float /*priority*/) {
  if (!level_) return false;
  if (!victims_.gathered()) victims_.gather(*scene_.cuts, scene_.importances);
  const std::optional<Victims::Victim> victim =
      victims_.take_back_below(turn_priority, *scene_.cuts, scene_.importances);
  if (!victim) return false;
  taken_back_[key_of(victim->object, victim->split)] = forced_.size();
  --stats_->splits;
  ++stats_->taken_back;
  if (victim->priority > 0.0F)
    queue_.push(
        {victim->priority, victim->error, victim->split, victim->object, 0, entries_.occluder(), Entry::Kind::apply});
  return true;
}

void FromScratch::apply_closure(const Entry& entry, const Cut::Closure& closure) {
  rejections_in_a_row_ = 0;
  entries_.steps().split_applied(entry.error.quadric_px);
  stats_->splits += closure.splits.size();
  const bool by_star = scene_.options->priority.culling == Culling::star;
  for (const SplitId s : closure.splits.subspan(1))
    forced_.push_back({entry.object, s, by_star && scene_.importances[entry.object].visible_share(s) == 0.0F});
  scene_.cuts->apply_closure(entry.object);
}

Growth FromScratch::growth() const {
  return {stats_->splits, scene_.cuts->triangle_count() - scene_.cuts->base_triangle_count()};
}

// At its step, and when all that is left is hidden by an occluder that has since been refined.
bool FromScratch::occluder_due() {
  if (!scene_.queries->can_hide() || level_) return false;
  if (entries_.steps().due(growth())) return true;
  return scene_.options->occluder.retest_hidden && queue_.empty() && scene_.queries->none_open() && !hidden().empty() &&
         stats_->splits > entries_.steps().last().splits;
}

}  // namespace occlod
