#include "refine/frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/platform.h"
#include "refine/tuning.h"
#include "splits/star.h"

namespace occlod {
namespace {

// Limits the depth of dependencies that are followed, so that no file can use up the stack.
constexpr int max_depth = 64;
// Number of frames for which the charges of a split are kept.
constexpr std::uint16_t max_age = 4;
// Larger charges count as this many splits, so that the priority of a leaf whose needs are kept by others anyway does
// not sink too far.
constexpr float max_kept = 2.0F;

std::uint32_t count_removed(const SplitStar& star, SplitId from) {
  std::uint32_t faces = 0;
  star.for_each_removed_ref([&](const FaceRef& face) { faces += face.split == from ? 1U : 0U; });
  return faces;
}

// Adds up charge_of(split) over the faces of other splits that a star removes. Those of one split mostly follow each
// other, and its charge is found once for these.
template <typename ChargeOf>
float sum_over_removed(const SplitStar& star, const ChargeOf& charge_of) {
  float sum = 0.0F, charge = 0.0F;
  SplitId last = no_id;
  star.for_each_removed_ref([&](const FaceRef& face) {
    if (face.split == no_id) return;
    if (std::exchange(last, face.split) != face.split) charge = charge_of(face.split);
    sum += charge;
  });
  return sum;
}

}  // namespace

// Finds at once which stars are seen of what these splits need, and which of `forced`: looking at one after the other
// would wait for the memory each time.
void UnseenNeeds::look_at_needs(std::uint32_t object, std::span<const SplitId> splits,
                                std::span<const SplitId> forced) {
  const Cut& cut = (*evaluation_.scene().cuts)[object];
  const Front& front = evaluation_.front(object);
  outdated_.clear();
  outdated_.reserve(front.room());
  worths_.reserve(front.room());
  const auto look_at = [&](Front::Index k) {
    if (k == Front::none || front.is(k, Front::hidden) || !front.priorities().is_outdated(k)) return;
    prefetch(&front.node(k));
    outdated_.push_back(k);
  };
  for (const SplitId s : forced) look_at(front.find(s));
  const Hierarchy& hierarchy = evaluation_.scene().hierarchy(object);
  for (std::size_t i = 0; i < splits.size(); ++i) {
    prefetch_stars_after(hierarchy, splits, i);
    SplitId last = no_id;
    star_of(hierarchy, splits[i]).for_each_removed_ref([&](const FaceRef& face) {
      if (face.split == no_id || std::exchange(last, face.split) == face.split) return;
      if (cut.applied(face.split)) look_at(front.find(face.split));
    });
  }
  if (outdated_.empty()) return;
  std::sort(outdated_.begin(), outdated_.end());
  outdated_.erase(std::unique(outdated_.begin(), outdated_.end()), outdated_.end());
  worths_.resize(outdated_.size());
  evaluation_.find_worths(object, outdated_, worths_);
}

float UnseenNeeds::weight_of_applied(std::uint32_t object, SplitId s) {
  return weight(object, s, std::min(needed_by(object, s, max_depth), max_kept));
}

float UnseenNeeds::weight_of_closure(std::uint32_t object, const Cut::Closure& closure) {
  float kept = 0.0F, forced = 0.0F;
  look_at_needs(object, closure.splits, closure.splits.subspan(1));
  for (const SplitId s : closure.splits) {
    kept += needed_by_unapplied(object, s);
    if (s != closure.splits[0]) forced += unseen_part(object, s);
  }
  return weight(object, closure.splits[0], std::min(kept, max_kept) + forced);
}

// Returns the charges of a split. If it removes several faces of another split, it is charged for each.
float UnseenNeeds::needed_by(std::uint32_t object, SplitId s, int depth) {
  const Cut& cut = (*evaluation_.scene().cuts)[object];
  const SplitStar star = star_of(evaluation_.scene().hierarchy(object), s);
  return sum_over_removed(star, [&](SplitId from) {
    return charge(object, from, count_removed(star, from), cut.removed_faces(from), depth);
  });
}

// Returns the charges for splits that are already applied.
float UnseenNeeds::needed_by_unapplied(std::uint32_t object, SplitId s) {
  const Cut& cut = (*evaluation_.scene().cuts)[object];
  const SplitStar star = star_of(evaluation_.scene().hierarchy(object), s);
  return sum_over_removed(star, [&](SplitId from) {
    if (!cut.applied(from)) return 0.0F;
    const std::uint32_t own = count_removed(star, from);
    return charge(object, from, own, own + cut.removed_faces(from), max_depth);
  });
}

// Returns the charge per face for `own` of the `removed` faces of s.
float UnseenNeeds::charge(std::uint32_t object, SplitId s, std::uint32_t own, std::uint32_t removed, int depth) {
  const float part = unseen_part(object, s);
  if (part == 0.0F) return 0.0F;
  const float whole = 1.0F + below(object, evaluation_.front(object).find(s), depth);
  return part * whole / std::sqrt(static_cast<float>(own) * static_cast<float>(removed));
}

// Returns the charges of an applied split, cached for max_age frames.
float UnseenNeeds::below(std::uint32_t object, Front::Index k, int depth) {
  Front& front = evaluation_.front(object);
  const auto now = static_cast<std::uint16_t>(frame_);
  const auto age = static_cast<std::uint16_t>(now - front.node(k).weighed_frame);
  if (front.is(k, Front::needs_known) && age < max_age) return front.node(k).unseen_needs;
  if (depth == 0) return 0.0F;
  const SplitId s = front.node(k).split;
  look_at_needs(object, {&s, 1}, {});
  const float found = needed_by(object, s, depth - 1);
  FrontNode& node = front.node(k);
  node.unseen_needs = found;
  node.weighed_frame = now;
  front.set(k, Front::needs_known, true);
  return found;
}

float UnseenNeeds::unseen_part(std::uint32_t object, SplitId s) {
  Front& front = evaluation_.front(object);
  const Front::Index k = front.find(s);
  if (k == Front::none) return 1.0F - evaluation_.scene().importances[object].visible_share(s);
  if (front.is(k, Front::hidden)) return 1.0F;
  if (front.priorities().is_outdated(k)) static_cast<void>(evaluation_.worth(object, k));
  return 1.0F - front.visible_share(k);
}

float UnseenNeeds::weight(std::uint32_t object, SplitId s, float unseen) const {
  const Tuning& tuning = tuning_of(*evaluation_.scene().options);
  const Front& front = evaluation_.front(object);
  const float covered = front.is(front.find(s), Front::covered) ? static_cast<float>(tuning.covered_factor) : 1.0F;
  if (tuning.forced_exponent == 1.0) return covered / (1.0F + unseen);
  return covered * std::pow(1.0F + unseen, -static_cast<float>(tuning.forced_exponent));
}

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
// When so many candidates need more triangles than are left, the budget counts as used up.
constexpr std::size_t max_rejections = 16;
constexpr std::size_t min_gain = 1;  // smallest number of triangles that a split adds: one at a boundary
// Where the queued candidates do not suffice, those down to this factor below them follow.
constexpr float band_step = 1.25F;
// Refinement from scratch does not charge leaves for what they keep, so its budget ends at a higher level than that of
// later frames. Those lower the level in steps that grow by settling_growth, rather than all at once, until it is
// settled_part of the adopted level.
constexpr float settling_growth = 1.12F, settled_part = 0.25F;
// A budget with less room than this, in triangles, counts as used up.
constexpr std::size_t min_room = 16;

}  // namespace

SplitExchange::SplitExchange(FrontEvaluation& evaluation, FrontForest& forest, FrontQueries& queries,
                             std::span<DrawnMesh> meshes)
    : evaluation_(evaluation), forest_(forest), queries_(queries), meshes_(meshes), unseen_needs_(evaluation) {}

void SplitExchange::begin_frame(std::uint32_t frame, Clock::time_point start, RefineStats& stats) {
  frame_ = frame;
  start_ = start;
  stats_ = &stats;
  changes_before_ = std::exchange(changes_, 0);
  next_ahead_ = candidates_at_once();
  rejected_ = {};
  settling_level_ /= settling_step_;
  settling_step_ *= settling_growth;
  if (settling_level_ < settled_part * adopted_level_) settling_level_ = 0.0F;
  unseen_needs_.begin_frame(frame);
}

void SplitExchange::run() {
  gather();
  exchange();
}

void SplitExchange::run_on(std::span<const Entry> shown) {
  for (const Entry& entry : shown) {
    const Front& front = evaluation_.front(entry.object);
    const Front::Index k = front.find(entry.split);
    if (front.is(k, Front::hidden) || front.is(k, Front::applied)) continue;
    if (front.is(k, Front::descended))
      enqueue_split(entry.object, k);
    else
      enqueue_visit(entry.object, k);
  }
  if (!candidates_.empty()) exchange();
}

std::optional<Entry> SplitExchange::visit_of(std::uint32_t object, Front::Index k) const {
  const Front& front = evaluation_.front(object);
  const ScreenError error = front.error_at_most(k);
  if (!(error.quadric_px > 0.0F) || front.is(k, Front::subtree_hidden) ||
      error.is_within(evaluation_.scene().options->tolerance_px))
    return std::nullopt;
  return Entry{error.quadric_px, error, front.node(k).split, object, front.node(k).level, 0, Entry::Kind::visit};
}

void SplitExchange::enqueue_visit(std::uint32_t object, Front::Index k) {
  if (const std::optional<Entry> entry = visit_of(object, k)) candidates_.push(*entry);
}

void SplitExchange::exchange() {
  const std::size_t budget = evaluation_.scene().options->budget;
  const CutSet& cuts = *evaluation_.scene().cuts;
  std::size_t rejections = 0;
  level_ = 0.0F;
  while (true) {
    if (cuts.triangle_count() > budget) {
      if (!take_back_least()) break;
      continue;
    }
    if (candidates_.empty() || candidates_.top().priority <= candidates_above_) gather_more_candidates();
    if (candidates_.empty() || candidates_.top().priority <= candidates_above_) {
      level_ = std::max(level_, candidates_above_);
      return;
    }
    if (limit_reached()) break;
    if (!is_looked_at(candidates_.top())) {
      look_ahead();
      continue;
    }
    Entry entry = candidates_.pop();
    if (apply_split(evaluation_.scene(), entry, *this)) continue;
    // Later candidates matter less and take no room from leaves either: they can only use what is left.
    level_ = std::max(level_, entry.priority);
    ++stats_->rejected_splits;
    rejected_.include(entry.error);
    if (++rejections == max_rejections || cuts.triangle_count() + min_gain > budget) return;
  }
  stats_->pending = !candidates_.empty();
  if (stats_->pending) level_ = std::max(level_, candidates_.top().priority);
}

void SplitExchange::gather() {
  const RefineOptions* const options = evaluation_.scene().options;
  candidates_.clear();
  leaves_.clear();
  for (std::uint32_t i = 0; i < evaluation_.object_count(); ++i) forest_.close(i, worthless_part * level_);
  candidates_above_ = level_ / level_band;
  last_step_ = worthless_part * level_;
  leaves_below_ = level_ * level_band;
  // If the budget is enough, all leaves are queued, because some may be needless.
  if (level_ == 0.0F && options->tolerance_px > 0.0) leaves_below_ = infinity;
  gather_candidates(candidates_above_, infinity);
  gather_leaves(0.0F, leaves_below_);
}

// Queues candidates with priorities in (low, high]: reached nodes at which refinement may go on.
void SplitExchange::gather_candidates(float low, float high) {
  const RefineOptions* const options = evaluation_.scene().options;
  const auto is_wanted = [&](float priority, const ScreenError& error) {
    return priority > low && priority <= high && !error.is_within(options->tolerance_px);
  };
  for (std::uint32_t i = 0; i < evaluation_.object_count(); ++i) {
    const Front& front = evaluation_.front(i);
    found_.clear();
    select(evaluation_.errors(i),
           {.all = Front::reached, .none = Front::descended | Front::subtree_hidden, .may_exceed = low}, found_);
    evaluation_.evaluate(i, found_);
    for (const Front::Index k : found_) {
      const ScreenError bound = front.error_at_most(k);
      const FrontNode& node = front.node(k);
      if (is_wanted(bound.quadric_px, bound))
        candidates_.push({bound.quadric_px, bound, node.split, i, node.level, 0, Entry::Kind::visit});
    }
    found_.clear();
    select(evaluation_.priorities(i),
           {.all = Front::reached | Front::descended, .none = Front::applied | Front::hidden, .may_exceed = low},
           found_);
    if (tuning_of(*options).culling == Culling::subtree) evaluation_.evaluate(i, found_);
    leave_out_low(i, low);
    find_worths(i);
    for (std::size_t at = 0; at < found_.size(); ++at) {
      const Front::Index k = found_[at];
      const SplitWorth& worth = worths_[at];
      const bool again = weighs_again(front, k);
      const float priority = again ? worth.own_priority : worth.priority;
      const FrontNode& node = front.node(k);
      if (is_wanted(priority, worth.error))
        candidates_.push({priority, worth.error, node.split, i, node.level, 0, Entry::Kind::apply, !again});
    }
  }
}

// Finds what the nodes in found_ are worth.
void SplitExchange::find_worths(std::uint32_t object) {
  worths_.reserve(evaluation_.front(object).room());
  worths_.resize(found_.size());
  evaluation_.find_worths(object, found_, worths_);
}

bool SplitExchange::weighs_again(const Front& front, Front::Index k) const {
  return !front.is(k, Front::weighed) || (front.node(k).split + frame_) % weighing_rounds == 0;
}

// Drops nodes from found_ whose priorities are at most `low`.
void SplitExchange::leave_out_low(std::uint32_t object, float low) {
  const Front& front = evaluation_.front(object);
  std::size_t kept = 0;
  for (const Front::Index k : found_) {
    const float most = evaluation_.priority_at_most(object, k);
    const bool is_low = (weighs_again(front, k) ? most : most * front.forced_weights()[k]) <= low;
    found_[kept] = k;
    kept += is_low ? 0 : 1;
  }
  found_.resize(kept);
}

// Returns whether other candidates are left to later frames. With a tolerance none are, because it is kept in each
// frame.
bool SplitExchange::waits_for_later_frames() const {
  const RefineOptions* const options = evaluation_.scene().options;
  return candidates_above_ <= settling_level_ && !(options->tolerance_px > 0.0) &&
         evaluation_.scene().cuts->triangle_count() + min_room > options->budget;
}

// Queues candidates until one precedes all that are not queued yet: a little less important ones each time, then all
// others, as far as this frame goes.
void SplitExchange::gather_more_candidates() {
  while (candidates_above_ > 0.0F && !waits_for_later_frames() &&
         (candidates_.empty() || candidates_.top().priority <= candidates_above_)) {
    const float below = candidates_above_;
    candidates_above_ = below > last_step_ ? below / band_step : 0.0F;
    gather_candidates(candidates_above_, below);
  }
}

// Weighs the leaves whose turn it is in this frame.
void SplitExchange::weigh_leaves(std::uint32_t object) {
  found_.clear();
  select(evaluation_.errors(object), {.all = Front::applied | Front::leaf, .none = Front::is_new | Front::hidden},
         found_);
  const Front& front = evaluation_.front(object);
  std::erase_if(found_, [&](Front::Index k) { return (front.node(k).split + frame_) % weighing_rounds != 0; });
  sorted_.clear();
  sorted_.reserve(front.room());
  for (const Front::Index k : found_) sorted_.push_back(front.node(k).split);
  unseen_needs_.look_at_needs(object, sorted_, {});
  for (const Front::Index k : found_) weigh_leaf(object, k);
}

void SplitExchange::weigh_leaf(std::uint32_t object, Front::Index k) {
  Front& front = evaluation_.front(object);
  front.forced_weight(k) = unseen_needs_.weight_of_applied(object, front.node(k).split);
}

// Queues applied splits that no other needs and whose priorities are in [low, high).
void SplitExchange::gather_leaves(float low, float high) {
  constexpr std::uint16_t wanted = Front::applied | Front::leaf;
  const RefineOptions* const options = evaluation_.scene().options;
  const float may_be_below = options->tolerance_px > 0.0 ? infinity : high;
  for (std::uint32_t i = 0; i < evaluation_.object_count(); ++i) {
    if (tuning_of(*options).culling == Culling::star) weigh_leaves(i);
    found_.clear();
    select(evaluation_.errors(i), {.all = wanted | Front::hidden, .none = Front::is_new}, found_);
    select(evaluation_.leaf_priorities(i),
           {.all = wanted, .none = Front::is_new | Front::hidden, .may_be_below = may_be_below}, found_);
    find_worths(i);
    for (std::size_t at = 0; at < found_.size(); ++at) {
      const float priority = leaf_priority(worths_[at]);
      if (priority >= low && priority < high) enqueue_leaf(i, evaluation_.front(i).node(found_[at]).split, priority);
    }
  }
}

// Queues all leaves that are left, also those whose priorities have sunk since the others were queued. Returns false
// when there are none.
bool SplitExchange::gather_more_leaves() {
  if (leaves_below_ == infinity) return false;
  leaves_below_ = infinity;
  gather_leaves(0.0F, leaves_below_);
  return !leaves_.empty();
}

bool SplitExchange::limit_reached() const {
  const RefineOptions* const options = evaluation_.scene().options;
  if (options->max_changes > 0 && changes_ >= options->max_changes) return true;
  return options->time_limit_ms > 0.0 && milliseconds_since(start_) >= options->time_limit_ms;
}

// Returns an entry for the split of a reached node if it is worth anything.
std::optional<Entry> SplitExchange::split_of(std::uint32_t object, Front::Index k, const SplitWorth& worth) const {
  if (!(worth.own_priority > 0.0F) || worth.error.is_within(evaluation_.scene().options->tolerance_px))
    return std::nullopt;
  const FrontNode& node = evaluation_.front(object).node(k);
  return Entry{worth.own_priority, worth.error, node.split, object, node.level, 0, Entry::Kind::apply};
}

void SplitExchange::enqueue_split(std::uint32_t object, Front::Index k) {
  if (const std::optional<Entry> entry = split_of(object, k, evaluation_.worth(object, k))) candidates_.push(*entry);
}

float SplitExchange::forced_weight(const Entry& entry, const Cut::Closure& closure) {
  Front& front = evaluation_.front(entry.object);
  const Front::Index k = front.find(entry.split);
  front.set(k, Front::weighed, true);
  return front.forced_weight(k) = unseen_needs_.weight_of_closure(entry.object, closure);
}

bool SplitExchange::step_back(const Entry& entry) {
  if (candidates_.would_be_next(entry)) return false;
  candidates_.push(entry);
  return true;
}

// Takes back the least important leaf if `priority` exceeds that of the leaf by the hysteresis. Returns false
// otherwise.
bool SplitExchange::make_room(float /*turn_priority*/, float priority) {
  const RefineOptions* const options = evaluation_.scene().options;
  const float most = priority * (1.0F - static_cast<float>(tuning_of(*options).hysteresis));
  // Leaves that are not queued yet matter at least as much as leaves_below_.
  if (leaves_.empty() && (most <= leaves_below_ || !gather_more_leaves())) return false;
  if (!(1.0F / leaves_.top().priority < most)) return false;
  return take_back_least();
}

void SplitExchange::apply_closure(const Entry& entry, const Cut::Closure& closure) {
  CutSet& cuts = *evaluation_.scene().cuts;
  Front& front = evaluation_.front(entry.object);
  sorted_.assign(closure.splits.begin(), closure.splits.end());
  std::sort(sorted_.begin(), sorted_.end());  // puts dependencies first
  cuts.apply_closure(entry.object);
  for (const SplitId s : sorted_) {
    meshes_[entry.object].apply(s);
    const Front::Index k = front.obtain(s);
    for (const Front::Flag flag : {Front::applied, Front::leaf, Front::is_new}) front.set(k, flag, true);
    for (const SplitId needed : star_of(cuts.hierarchy(entry.object), s).dependencies())
      front.set(front.find(needed), Front::leaf, false);
  }
  changes_ += sorted_.size();
  note_forced(entry, closure);
}

void SplitExchange::note_forced(const Entry& entry, const Cut::Closure& closure) {
  const bool by_star = tuning_of(*evaluation_.scene().options).culling == Culling::star;
  Front& front = evaluation_.front(entry.object);
  for (const SplitId s : closure.splits) {
    const Front::Index k = front.find(s);
    const bool forced = s != entry.split;
    front.set(k, Front::forced, forced);
    front.set(
        k, Front::forced_unseen,
        forced && by_star &&
            (front.is(k, Front::hidden) || evaluation_.scene().importances[entry.object].visible_share(s) == 0.0F));
  }
}

// Returns whether a queued leaf is still an applied leaf of earlier frames.
bool SplitExchange::is_old_leaf(const Entry& leaf) const {
  if (!(*evaluation_.scene().cuts)[leaf.object].applied(leaf.split)) return false;
  const Front& front = evaluation_.front(leaf.object);
  const Front::Index k = front.find(leaf.split);
  return front.is(k, Front::leaf) && !front.is(k, Front::is_new);
}

// Takes back the least important leaf. Returns false when none is left.
bool SplitExchange::take_back_least() {
  while (!leaves_.empty() || gather_more_leaves()) {
    const Entry leaf = leaves_.pop();
    if (!is_old_leaf(leaf)) continue;
    take_back(leaf.object, leaf.split);
    return true;
  }
  return false;
}

void SplitExchange::take_back_needless() {
  const RefineOptions* const options = evaluation_.scene().options;
  if (stats_->pending) return;
  if (!(options->tolerance_px > 0.0)) {
    if (level_ > 0.0F) return;
    leaves_.clear();
    leaves_below_ = infinity;
    gather_leaves(0.0F, std::numeric_limits<float>::min());
  }
  while (!limit_reached() && !leaves_.empty() && std::isinf(leaves_.top().priority)) {
    const Entry leaf = leaves_.pop();
    if (is_old_leaf(leaf)) take_back(leaf.object, leaf.split);
  }
}

void SplitExchange::take_back(std::uint32_t object, SplitId s) {
  Front& front = evaluation_.front(object);
  const Front::Index k = front.find(s);
  ++changes_;
  ++stats_->taken_back;
  for (const Front::Flag flag : {Front::applied, Front::leaf, Front::is_new}) front.set(k, flag, false);
  const auto note_leaves = [&](SplitId needed) { enqueue_new_leaf(object, needed); };
  meshes_[object].take_back(s);
  evaluation_.scene().cuts->take_back(object, s, note_leaves);
  if (front.is(k, Front::reached))
    enqueue_split(object, k);  // it may be applied again when less important leaves have appeared
  else
    front.remove(k);
}

void SplitExchange::enqueue_new_leaf(std::uint32_t object, SplitId s) {
  Front& front = evaluation_.front(object);
  const Front::Index k = front.find(s);
  front.set(k, Front::leaf, true);
  if (front.is(k, Front::is_new)) return;
  // The new leaf may well be hidden too, and then its room is wanted now.
  queries_.ask_about_new_leaf(object, k);
  if (tuning_of(*evaluation_.scene().options).culling == Culling::star) {
    unseen_needs_.look_at_needs(object, {&s, 1}, {});
    weigh_leaf(object, k);
  }
  const float priority = leaf_priority(evaluation_.worth(object, k));
  if (priority < leaves_below_) enqueue_leaf(object, s, priority);
}

void SplitExchange::enqueue_leaf(std::uint32_t object, SplitId s, float priority) {
  leaves_.push({1.0F / priority, {}, s, object});  // infinite for a priority of 0
}

// Returns 0 for leaves that a tolerance makes needless. The result is finite even with the eye inside the bounds, so
// that every leaf can be given up.
float SplitExchange::leaf_priority(const SplitWorth& worth) const {
  const RefineOptions* const options = evaluation_.scene().options;
  const double needless = options->tolerance_px * (1.0 - tuning_of(*options).hysteresis);
  if (static_cast<double>(worth.error.guaranteed_px) <= needless) return 0.0F;
  return std::min(worth.priority, std::numeric_limits<float>::max());
}

namespace {

// When more than this share of the applied splits has become worthless, it is better to start from scratch.
constexpr double lost_part = 0.25;

// In a view that does not move, exchanges after this many frames only go back and forth.
constexpr std::uint32_t max_restless_frames = 4 * weighing_rounds;

// What the mesh of a frame turns out to show matters much when its error is this many times the level.
constexpr float much_error = 4.0F;
// After this many consecutive checks that showed nothing, one frame in rare_checks is checked.
constexpr std::uint32_t max_useless_checks = 8, rare_checks = 4;

std::vector<DrawnMesh> meshes_of(std::span<const RefineObject> objects, std::span<RefinedObject> result) {
  std::vector<DrawnMesh> meshes;
  for (std::size_t i = 0; i < objects.size(); ++i) meshes.emplace_back(*objects[i].hierarchy, result[i].triangles);
  return meshes;
}

}  // namespace

Frames::Frames(std::span<const RefineObject> objects, std::span<RefinedObject> result)
    : evaluation_(objects),
      forest_(evaluation_),
      queries_(evaluation_),
      meshes_(meshes_of(objects, result)),
      exchange_(evaluation_, forest_, queries_, meshes_) {}

void Frames::begin() {
  ++frame_;
  for (DrawnMesh& mesh : meshes_) mesh.begin_frame();
}

void Frames::adopt(const RefinedScene& scene, float level, std::span<const Entry> hidden) {
  begin();
  at_rest_ = false;
  evaluation_.restart(scene);
  exchange_.adopt(level);
  for (std::uint32_t i = 0; i < meshes_.size(); ++i) {
    meshes_[i].assign((*scene.cuts)[i]);
    forest_.adopt_splits(i);
  }
  queries_.adopt(hidden);
  for (std::uint32_t i = 0; i < meshes_.size(); ++i) forest_.adopt_forest(i, level);
  before_ = evaluation_.count_applied(worthless_part * level);
}

bool Frames::move_to(const RefinedScene& scene) {
  begin();
  evaluation_.move_to(scene);
  const AppliedCount now = evaluation_.count_applied(worthless_part * exchange_.level());
  const double newly_lost = static_cast<double>(now.worthless) - static_cast<double>(before_.worthless);
  return newly_lost <= lost_part * static_cast<double>(now.all);
}

void Frames::advance(bool moved, Clock::time_point start, RefineStats& stats) {
  if (moved) moved_frame_ = frame_;
  queries_.begin_frame(frame_, moved);
  exchange_.begin_frame(frame_, start, stats);
  exchange_splits(moved, stats);
  exchange_.take_back_needless();
  before_ = evaluation_.count_applied(worthless_part * exchange_.level());
  const bool all_asked = !evaluation_.scene().queries->can_hide() || frame_ - moved_frame_ >= asking_rounds;
  at_rest_ = !stats.pending && all_asked && exchange_.has_settled();
  measure(stats);
}

// Exchanges splits, where hidden ones give way. Where the mesh of the frame before bulged, this mesh hides less: what
// turns out to be visible is applied after all, if it matters much; the rest waits for the next frame.
void Frames::exchange_splits(bool moved, RefineStats& stats) {
  const RefinedScene& scene = evaluation_.scene();
  const bool can_hide = scene.queries->can_hide();
  if (can_hide)
    stats.readmitted += queries_.ask_again(exchange_.level());
  else
    queries_.forget_hidden();
  exchange_.run();
  // A picture tells no more of this mesh than before the exchange.
  const bool is_final = scene.queries->from_picture() || exchange_.changes() == 0;
  if (!can_hide || !moved || !tuning_of(*scene.options).final_check || is_final) return;
  if (checks_since_useful_ > max_useless_checks && frame_ % rare_checks != 0) return;
  const std::span<const Entry> shown = queries_.check_hidden(much_error * exchange_.level());
  checks_since_useful_ = shown.empty() ? checks_since_useful_ + 1 : 1;
  stats.readmitted += shown.size();
  exchange_.run_on(shown);
}

void Frames::measure(RefineStats& stats) {
  ScreenError left = exchange_.rejected_error();
  evaluation_.measure_errors(left);
  stats.triangles = evaluation_.scene().cuts->triangle_count();
  evaluation_.count_nodes(stats);
  stats.level_px = static_cast<double>(exchange_.level());
  stats.max_error_px = static_cast<double>(left.guaranteed_px);
  stats.max_quadric_error_px = static_cast<double>(left.quadric_px);
}

void Frames::emit(std::span<RefinedObject> out, RefineStats& stats) {
  const RefinedScene& scene = evaluation_.scene();
  const RefineOptions* const options = scene.options;
  for (std::uint32_t i = 0; i < meshes_.size(); ++i) {
    Front& front = evaluation_.front(i);
    for (const SplitId s : meshes_[i].born())
      if (const Front::Index k = front.find(s); k != Front::none) front.set(k, Front::is_new, false);
    meshes_[i].emit((*scene.cuts)[i], options->geomorph_frames, out[i], stats);
    for (const SplitId s : meshes_[i].born()) {
      const Front::Index k = front.find(s);
      if (front.is(k, Front::forced)) ++stats.forced_splits;
      if (front.is(k, Front::forced_unseen)) ++stats.forced_unseen_splits;
    }
    at_rest_ = at_rest_ && out[i].geomorphs.empty();
  }
  // A split may be taken back in vain again and again, for a candidate that finds no room anyway.
  const bool same_mesh = stats.new_splits + stats.merged_splits == 0;
  same_frames_ = same_mesh && frame_ != moved_frame_ ? same_frames_ + 1 : 0;
  at_rest_ = at_rest_ && (exchange_.changes() == 0 || same_frames_ >= weighing_rounds ||
                          frame_ - moved_frame_ >= max_restless_frames);
}

}  // namespace occlod
