#include "refine/from_scratch.h"

#include <algorithm>

#include "base/platform.h"
#include "base/threads.h"
#include "base/timing.h"
#include "refine/refined_scene.h"
#include "refine/tuning.h"
#include "refine/weigh.h"
#include "splits/star.h"

namespace occlod {
namespace {

// Orders a heap with the least important on top; ties go by object and split, fine ones first.
bool less_urgent(const Victims::Victim& a, const Victims::Victim& b) {
  if (a.priority != b.priority) return a.priority > b.priority;
  if (a.object != b.object) return a.object > b.object;
  return a.split < b.split;
}

}  // namespace

void Victims::clear() noexcept {
  heap_.clear();
  gathered_ = false;
}

void Victims::gather(const CutSet& cuts, std::span<Importance> importances) {
  clear();
  for (std::uint32_t i = 0; i < cuts.size(); ++i) {
    leaves_.clear();
    for (const SplitId s : cuts[i].applied_splits())
      if (cuts[i].applied(s) && cuts[i].is_leaf(s)) leaves_.push_back(s);
    values_.resize(leaves_.size());
    importances[i].find(leaves_, values_);
    for (std::size_t k = 0; k < leaves_.size(); ++k)
      heap_.push_back({i, leaves_[k], values_[k].priority, values_[k].error});
  }
  std::make_heap(heap_.begin(), heap_.end(), less_urgent);
  gathered_ = true;
}

std::optional<Victims::Victim> Victims::take_back_below(float priority, CutSet& cuts,
                                                        std::span<Importance> importances) {
  while (!heap_.empty() && heap_.front().priority < priority) {
    std::pop_heap(heap_.begin(), heap_.end(), less_urgent);
    const Victim victim = heap_.back();
    heap_.pop_back();
    const Cut& cut = cuts[victim.object];
    if (!cut.applied(victim.split) || !cut.is_leaf(victim.split)) continue;  // changed since it was pushed
    cuts.take_back(victim.object, victim.split,
                   [&](SplitId needed) { push(victim.object, needed, importances[victim.object]); });
    return victim;
  }
  return std::nullopt;
}

void Victims::push(std::uint32_t object, SplitId s, Importance& importance) {
  const Importance::Value value = importance.of(s);
  heap_.push_back({object, s, value.priority, value.error});
  std::push_heap(heap_.begin(), heap_.end(), less_urgent);
}

void WaitingSplits::clear() noexcept {
  entries_.clear();
  waits_.clear();
  links_.clear();
  std::fill(slots_.begin(), slots_.end(), Slot{});
  used_slots_ = 0;
}

void WaitingSplits::wait(const Entry& entry, std::span<const SplitId> needed) {
  const auto waiting = static_cast<std::uint32_t>(entries_.size());
  entries_.push_back(entry);
  waits_.push_back(true);
  for (const SplitId s : needed) {
    if (2 * (used_slots_ + 1) > slots_.size()) grow();
    Slot& slot = slot_of(entry.object, s);
    if (slot.needed == no_id) {
      slot = {s, entry.object, none};
      ++used_slots_;
    }
    links_.push_back({waiting, slot.first});
    slot.first = static_cast<std::uint32_t>(links_.size() - 1);
  }
}

void WaitingSplits::wake(std::uint32_t object, std::span<const SplitId> applied, std::vector<Entry>& woken) {
  if (used_slots_ == 0) return;
  for (const SplitId s : applied)
    for (std::uint32_t at = slot_of(object, s).first; at != none; at = links_[at].next) {
      if (waits_[links_[at].entry]) woken.push_back(entries_[links_[at].entry]);
      waits_[links_[at].entry] = false;
    }
}

WaitingSplits::Slot& WaitingSplits::slot_of(std::uint32_t object, SplitId needed) {
  const std::uint64_t mixed = (std::uint64_t{object} << 32U | needed) * 0x9E3779B97F4A7C15U;
  std::size_t at = static_cast<std::size_t>(mixed >> 32U) & (slots_.size() - 1);
  while (slots_[at].needed != no_id && (slots_[at].needed != needed || slots_[at].object != object))
    at = (at + 1) & (slots_.size() - 1);
  return slots_[at];
}

void WaitingSplits::grow() {
  constexpr std::size_t min_slots = 1024;
  std::vector<Slot> old(std::max(min_slots, 2 * slots_.size()));
  old.swap(slots_);
  for (const Slot& slot : old)
    if (slot.needed != no_id) slot_of(slot.object, slot.needed) = slot;
}

void EntryQueries::begin(const RefinedScene& scene) {
  scene_ = scene;
  queries_ = scene.queries;
  steps_.begin(*scene.options);
  occluder_ = 0;
  hidden_.clear();
}

void EntryQueries::hide(const Entry& entry) {
  hidden_.push_back(entry);
  if (entry.kind == Entry::Kind::apply) scene_.importances[entry.object].set_hidden(entry.split, true);
}

// Forgets that an older occluder hid the entry, because that may no longer be true.
void EntryQueries::forget_verdict(const Entry& entry) const {
  if (entry.kind == Entry::Kind::apply) scene_.importances[entry.object].set_hidden(entry.split, false);
}

void EntryQueries::set_covered(Entry& entry, bool covered) const {
  const RefineOptions* const options = scene_.options;
  const auto factor = static_cast<float>(tuning_of(*options).covered_factor);
  entry.covered = covered;
  entry.priority *= covered ? factor : 1.0F / factor;
}

void EntryQueries::take_out_hidden(std::vector<Entry>& entries, Questions& questions) const {
  auto& [asked, places, newly_covered, verdicts, scratch, milliseconds] = questions;
  const Clock::time_point start = Clock::now();
  asked.clear();
  places.clear();
  newly_covered.clear();
  milliseconds = 0.0;
  if (occluder_ == 0) return;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!must_ask(entries[i])) continue;
    asked.push_back(entries[i]);
    places.push_back(i);
  }
  if (asked.empty()) return;
  verdicts.resize(asked.size());
  queries_->find(asked, verdicts, scratch);
  std::size_t next = 0, kept = places.front();
  for (std::size_t i = kept; i < entries.size(); ++i) {
    Entry entry = entries[i];
    if (next < places.size() && places[next] == i) {
      const OcclusionQueries::Verdict& verdict = verdicts[next++];
      if (!verdict.visible) continue;
      entry.asked_occluder = occluder_;
      entry.star_shows = verdict.vertex_shows;
      if (verdict.covered != entry.covered) {
        set_covered(entry, verdict.covered);
        if (entry.covered) {
          newly_covered.push_back(entry);
          continue;
        }
      }
    }
    entries[kept++] = entry;
  }
  entries.resize(kept);
  milliseconds = milliseconds_since(start);
}

void EntryQueries::note_answers(const Questions& questions, bool own_time) {
  queries_->count(questions.asked, questions.verdicts, own_time ? questions.milliseconds : 0.0);
  for (std::size_t i = 0; i < questions.asked.size(); ++i)
    if (!questions.verdicts[i].visible) hide(questions.asked[i]);
}

void EntryQueries::draw_occluder(EntryQueues& queues, const Growth& now) {
  const RefineOptions* const options = scene_.options;
  queries_->draw_occluder(*scene_.cuts);
  steps_.drawn(now);
  ++occluder_;
  if (!tuning_of(*options).retest_hidden) return;
  for (const Entry& entry : hidden_) {  // as in Birkholz & Rahn, sec. 3.2
    forget_verdict(entry);
    queues.push(entry);
  }
  hidden_.clear();
}

std::size_t EntryQueries::ask_again_about_hidden(EntryQueues& queues, const Growth& now) {
  doubtful_.clear();
  doubtful_.swap(hidden_);
  draw_occluder(queues, now);
  for (const Entry& entry : doubtful_) forget_verdict(entry);
  take_out_hidden(doubtful_, about_doubtful_);
  note_answers(about_doubtful_);
  for (const Entry& entry : doubtful_) queues.push(entry);
  for (const Entry& entry : about_doubtful_.newly_covered) queues.push(entry);
  return doubtful_.size() + about_doubtful_.newly_covered.size();
}

void NodeVisits::begin(const RefinedScene& scene, const EntryQueries& entries, std::span<const Entry> visits,
                       unsigned threads) {
  constexpr std::size_t piece_size = 64;
  scene_ = scene;
  entries_ = &entries;
  piece_count_ = (visits.size() + piece_size - 1) / piece_size;
  if (pieces_.size() < piece_count_) pieces_.resize(piece_count_);
  if (scratch_.size() < threads) scratch_.resize(threads);
  for (std::size_t i = 0; i < piece_count_; ++i) {
    const std::span<const Entry> part =
        visits.subspan(i * piece_size, std::min(piece_size, visits.size() - i * piece_size));
    pieces_[i].visits.assign(part.begin(), part.end());
  }
  next_ = 0;
}

void NodeVisits::work(unsigned thread) {
  for (std::size_t i = next_.fetch_add(1); i < piece_count_; i = next_.fetch_add(1)) {
    Piece& piece = pieces_[i];
    piece.by_caller = thread == 0;
    entries_->take_out_hidden(piece.visits, piece.questions);
    evaluate(piece, scratch_[thread]);
  }
}

void NodeVisits::evaluate(Piece& piece, Scratch& scratch) const {
  const std::span<const Entry> visits = piece.visits;
  piece.found.resize(visits.size());
  for (std::size_t first = 0, end = 0; first < visits.size(); first = end) {
    while (end < visits.size() && visits[end].object == visits[first].object) ++end;
    evaluate_object(visits.subspan(first, end - first), std::span(piece.found).subspan(first, end - first), scratch);
  }
}

// Evaluates nodes of one object, in steps, so that memory is fetched for some while others are processed.
void NodeVisits::evaluate_object(std::span<const Entry> visits, std::span<Found> found, Scratch& scratch) const {
  auto& [star_visibility, splits, children, stars, scales_px] = scratch;
  const std::uint32_t object = visits.front().object;
  const Hierarchy& hierarchy = scene_.hierarchy(object);
  const ObjectView& view = scene_.views[object];
  const RefineOptions* const options = scene_.options;
  const bool wants_stars = tuning_of(*options).culling == Culling::star;
  const bool attributes = scene_.objects[object].attributes;
  splits.clear();
  children.clear();
  for (const Entry& visit : visits) prefetch(&hierarchy.node(visit.split));
  for (const Entry& visit : visits) {
    const SplitNode& node = hierarchy.node(visit.split);
    if (wants_stars) prefetch(hierarchy.data().stars.data() + node.star);
    splits.push_back(visit.split);
    for (const SplitId child : {node.child_u, node.child_v}) {
      children.push_back(child);
      if (child != no_id) prefetch(&hierarchy.node(child));
    }
  }
  if (wants_stars) {
    for (const SplitId s : splits)
      if (const SplitStar star = star_of(hierarchy, s); star.is_fan())
        for (const VertexId v : star.ring()) prefetch(&hierarchy.positions()[v]);
    stars.resize(splits.size());
    star_visibility.evaluate(hierarchy, splits, view, scene_.objects[object].two_sided, stars);
    for (std::size_t i = 0; i < found.size(); ++i) {
      found[i].value = scene_.importances[object].of(stars[i], errors_of(hierarchy, splits[i], attributes));
    }
  }
  scales_px.resize(children.size());
  weigh_splits(hierarchy, children, view, scene_.gate->tests_cone(object), scales_px);
  for (std::size_t i = 0; i < children.size(); ++i) {
    Child& child = found[i / 2].children[i % 2];
    child = {children[i], scales_px[i], {}};
    if (child.split == no_id) continue;
    require_parent(hierarchy, child.split, splits[i / 2]);
    child.error = ScreenError(errors_of(hierarchy, child.split, attributes), child.scale_px);
  }
}

namespace {

// After this many consecutive visible splits have needed more triangles than are left, or in the final check than less
// important splits have, the budget counts as used up.
constexpr std::size_t max_rejections_in_a_row = 64, max_in_final_check = 256;

// Larger budgets look at more data than the caches hold.
constexpr std::size_t max_cached_triangles = 100'000;

std::uint64_t key_of(std::uint32_t object, SplitId s) { return std::uint64_t{object} << 32U | s; }

}  // namespace

void FromScratch::refine(const RefinedScene& scene, RefineStats& stats) {
  scene_ = scene;
  stats_ = &stats;
  waits_for_memory_ = scene.options->budget > max_cached_triangles;
  begin();
  run();
  end_level_ = queues_.top_priority();
  const RefineOptions* const options = scene_.options;
  if (tuning_of(*options).final_check) readmit();
  finish();
}

void FromScratch::begin() {
  scene_.cuts->clear();
  queues_.clear();
  entries_.begin(scene_);
  victims_.clear();
  waiting_.clear();
  forced_.clear();
  taken_back_.clear();
  rejections_in_a_row_ = 0;
  left_ = {};
  level_.reset();
  for (std::uint32_t i = 0; i < scene_.objects.size(); ++i) enqueue_roots(i);
}

void FromScratch::run() {
  const struct Waits {
    FromScratch* self;
    ~Waits() {
      self->visits_.end();
      self->beside_.abandon();
    }
  } waits{this};
  while (!used_up()) {
    if (occluder_due()) draw_occluder();
    take_visits();
    start_visits();
    const bool applied = apply_above_visits();
    if (taken_visits_.empty() && !applied) break;
    if (used_up() && !visits_known_) {  // the visits would be useless
      for (const Entry& entry : taken_visits_) queues_.push(entry);
      break;
    }
    finish_visits();
    enqueue_found();
  }
}

// Takes all nodes of the worst band that matter, or as many bands as a backend needs that answers many queries as fast
// as one.
void FromScratch::take_visits() {
  const std::size_t least = entries_.occluder() > 0 && scene_.queries->in_flights() ? scene_.queries->flight() : 1;
  taken_visits_.clear();
  Queue& visits = queues_.visits;
  while (taken_visits_.size() < least && !visits.empty() && matters(visits.top())) {
    visits_band_ = visits.top_band();
    while (!visits.empty() && visits.top_band() == visits_band_ && matters(visits.top()))
      taken_visits_.push_back(visits.pop());
  }
  const auto object_of = [](const Entry& entry) { return entry.object; };
  if (!std::ranges::is_sorted(taken_visits_, {}, object_of)) std::ranges::stable_sort(taken_visits_, {}, object_of);
}

// Starts visits, which other threads may work on while splits are applied, until the next occluder is drawn.
void FromScratch::start_visits() {
  visits_.begin(scene_, entries_, taken_visits_, scene_.threads);
  visits_known_ = false;
  const RefineOptions* const options = scene_.options;
  const bool is_worth_it = tuning_of(*options).culling == Culling::star || waits_for_memory_;
  if (!is_worth_it || !scene_.queries->many_threads_may_ask()) return;
  const auto pieces = static_cast<unsigned>(std::min<std::size_t>(visits_.piece_count(), scene_.threads));
  beside_.start(std::min(pieces, scene_.threads - 1), work_beside_);
}

void FromScratch::finish_visits() {
  if (visits_known_) return;
  visits_.work(0);
  beside_.finish();
  visits_known_ = true;
  for (const NodeVisits::Piece& piece : visits_.pieces()) entries_.note_answers(piece.questions, piece.by_caller);
}

void FromScratch::enqueue_found() {
  const RefineOptions* const options = scene_.options;
  const bool by_star = tuning_of(*options).culling == Culling::star;
  for (const NodeVisits::Piece& piece : visits_.pieces()) {
    if (!by_star) apply_visited(piece.visits);
    for (std::size_t i = 0; i < piece.visits.size(); ++i) {
      const Entry& entry = piece.visits[i];
      if (by_star) enqueue_split(entry, piece.found[i].value);
      for (const NodeVisits::Child& child : piece.found[i].children)
        if (child.split != no_id) enqueue_node({entry.object, entry.level + 1}, child);
    }
  }
}

// Applies what may be seen, with Culling::subtree.
void FromScratch::apply_visited(std::span<const Entry> visits) {
  applies_.assign(visits.begin(), visits.end());
  for (Entry& entry : applies_) entry.kind = Entry::Kind::apply;
  apply_taken();
}

// Applies splits, worst first, while they are worse than the nodes being visited. Returns false when there is none.
bool FromScratch::apply_above_visits() {
  bool any = false;
  while (!used_up() && take_applies()) {
    any = true;
    apply_taken();
  }
  return any;
}

// Returns whether nothing is left to do about a split: it has been applied, or hidden, when it was forced or before it
// was queued again.
bool FromScratch::is_done(const Entry& entry) const {
  Importance& importance = scene_.importances[entry.object];
  return (*scene_.cuts)[entry.object].applied(entry.split) ||
         (importance.knows_share(entry.split) && importance.visible_share(entry.split) == 0.0F);
}

// Takes the next splits. Returns false when there is none whose turn it is.
bool FromScratch::take_applies() {
  const std::size_t max_at_once = std::max<std::size_t>(128, scene_.queries->flight());
  Queue& applies = queues_.applies;
  applies_.clear();
  while (applies_.size() < max_at_once && !applies.empty() && matters(applies.top()) &&
         is_above_visits(applies.top())) {
    const Entry entry = applies.pop();
    if (!is_done(entry)) applies_.push_back(entry);
  }
  return !applies_.empty();
}

// Applies the splits that are seen, until the budget is used up.
void FromScratch::apply_taken() {
  entries_.take_out_hidden(applies_, about_applies_);
  entries_.note_answers(about_applies_);
  for (const Entry& entry : about_applies_.newly_covered) queues_.push(entry);
  look_at_needed();
  for (turn_ = 0; turn_ < applies_.size(); ++turn_) {
    if (used_up() || step_due()) break;
    woken_.clear();
    apply(applies_[turn_]);
    if (!used_up()) take_woken();
  }
  while (applies_.size() > turn_) {
    queues_.push(applies_.back());
    applies_.pop_back();
  }
  if (!used_up() && step_due()) {
    finish_visits();  // they have been asked about with the old occluder
    draw_occluder();
  }
}

// Lets woken entries that are seen have the next turns, so that none is left over when the budget ends.
void FromScratch::take_woken() {
  std::erase_if(woken_, [&](const Entry& entry) { return is_done(entry); });
  if (woken_.empty()) return;
  entries_.take_out_hidden(woken_, about_woken_);
  entries_.note_answers(about_woken_);
  for (const Entry& entry : about_woken_.newly_covered) queues_.push(entry);
  applies_.insert(applies_.begin() + static_cast<std::ptrdiff_t>(turn_) + 1, woken_.begin(), woken_.end());
}

// Puts an entry in its place among the taken ones, or into the queue behind them. Returns false when it is next anyway.
bool FromScratch::step_back(const Entry& entry) {
  const auto next = applies_.begin() + static_cast<std::ptrdiff_t>(turn_) + 1;
  const auto place =
      std::find_if(next, applies_.end(), [&](const Entry& other) { return Queue::may_precede(entry, other); });
  const bool is_next =
      place == next && (place != applies_.end() || (is_above_visits(entry) && queues_.applies.would_be_next(entry)));
  if (is_next) return false;
  if (place != applies_.end())
    applies_.insert(place, entry);
  else
    queues_.push(entry);
  return true;
}

// Prefetches, in steps, what the splits and those that they will force read from memory, and finds the visible shares
// of the latter together.
void FromScratch::look_at_needed() {
  const RefineOptions* const options = scene_.options;
  const bool by_star = tuning_of(*options).culling == Culling::star;
  if (!by_star && !waits_for_memory_) return;
  for (const Entry& entry : applies_) prefetch(&scene_.hierarchy(entry.object).node(entry.split));
  for (const Entry& entry : applies_) {
    const Hierarchy& hierarchy = scene_.hierarchy(entry.object);
    prefetch(hierarchy.data().stars.data() + hierarchy.node(entry.split).star);
  }
  for (const Entry& entry : applies_) (*scene_.cuts)[entry.object].prefetch_needs(entry.split);
  for (std::size_t first = 0, end = 0; first < applies_.size(); first = end) {
    const std::uint32_t object = applies_[first].object;
    const Hierarchy& hierarchy = scene_.hierarchy(object);
    const Cut& cut = (*scene_.cuts)[object];
    needed_.clear();
    for (; end < applies_.size() && applies_[end].object == object; ++end)
      for (const SplitId needed : star_of(hierarchy, applies_[end].split).dependencies()) {
        if (cut.applied(needed)) continue;
        hierarchy.require(needed);
        prefetch(&hierarchy.node(needed));
        needed_.push_back(needed);
      }
    for (const SplitId needed : needed_) prefetch(hierarchy.data().stars.data() + hierarchy.node(needed).star);
    if (by_star) scene_.importances[object].find_shares(needed_);
    for (const SplitId needed : needed_) cut.prefetch_needs(needed);
  }
}

void FromScratch::draw_occluder() { entries_.draw_occluder(queues_, growth()); }

bool FromScratch::used_up() const {
  if (rejections_in_a_row_ >= (level_ ? max_in_final_check : max_rejections_in_a_row)) return true;
  return !level_ && scene_.cuts->triangle_count() >= scene_.options->budget;
}

// Asks once more about what earlier occluders hid, with the current mesh as occluder. What this shows takes the place
// of what matters less.
void FromScratch::readmit() {
  if (entries_.occluder() == 0 || hidden().empty() || stats_->splits == entries_.steps().last().splits) return;
  level_ = queues_.top_priority();
  rejections_in_a_row_ = 0;
  stats_->readmitted = entries_.ask_again_about_hidden(queues_, growth());
  run();
}

void FromScratch::finish() {
  count_forced();
  stats_->nodes = stats_->visits;
  stats_->triangles = scene_.cuts->triangle_count();
  stats_->culled_occlusion = hidden().size();
  queues_.for_each([&](const Entry& entry) {
    if (left_.includes(entry.error)) return;
    if (!(*scene_.cuts)[entry.object].applied(entry.split)) left_.include(entry.error);
  });
  stats_->level_px = static_cast<double>(end_level_);
  stats_->max_error_px = static_cast<double>(left_.guaranteed_px);
  stats_->max_quadric_error_px = static_cast<double>(left_.quadric_px);
}

// Counts forced splits that are still applied.
void FromScratch::count_forced() {
  for (std::size_t i = 0; i < forced_.size(); ++i) {
    const auto back = taken_back_.find(key_of(forced_[i].object, forced_[i].split));
    if (back != taken_back_.end() && i < back->second) continue;
    ++stats_->forced_splits;
    if (forced_[i].unseen) ++stats_->forced_unseen_splits;
  }
}

void FromScratch::enqueue_roots(std::uint32_t object) {
  const Hierarchy& hierarchy = scene_.hierarchy(object);
  const std::span<const SplitId> roots = hierarchy.data().roots;
  root_scales_px_.resize(roots.size());
  weigh_splits(hierarchy, roots, scene_.views[object], scene_.gate->tests_cone(object), root_scales_px_);
  for (std::size_t i = 0; i < roots.size(); ++i) {
    require_parent(hierarchy, roots[i], no_id);
    enqueue_node({object, 0},
                 {roots[i], root_scales_px_[i],
                  ScreenError(errors_of(hierarchy, roots[i], scene_.objects[object].attributes), root_scales_px_[i])});
  }
}

// Drops a newly reached node for good, or queues it.
void FromScratch::enqueue_node(const Place& at, const NodeVisits::Child& node) {
  ++stats_->visits;
  if (node.scale_px == scale_outside) {
    ++stats_->culled_frustum;
    return;
  }
  if (scene_.gate->tests_cone(at.object) && scene_.gate->cone_culled(at.object, node.scale_px == scale_facing_away)) {
    ++stats_->culled_backface;
    return;
  }
  if (leaves(node.error)) return;
  queues_.push({node.error.quadric_px, node.error, node.split, at.object, at.level, 0, Entry::Kind::visit});
}

// Queues a node's own split if it changes anything that is seen, with Culling::star.
void FromScratch::enqueue_split(const Entry& node, const Importance::Value& value) {
  if ((*scene_.cuts)[node.object].applied(node.split)) return;
  scene_.importances[node.object].remember(node.split, value.visible_share);
  if (value.visible_share == 0.0F) {
    ++stats_->culled_backface;
    return;
  }
  if (leaves(value.error)) return;
  queues_.push({value.priority, value.error, node.split, node.object, node.level,
                node.star_shows ? node.asked_occluder : 0, Entry::Kind::apply});
}

// Returns whether an error is small enough to be left; if so, counts it as left.
bool FromScratch::leaves(const ScreenError& error) {
  if (!error.is_within(scene_.options->tolerance_px)) return false;
  left_.include(error);
  return true;
}

void FromScratch::apply(Entry entry) {
  if (apply_split(scene_, entry, *this)) return;
  ++stats_->rejected_splits;
  ++rejections_in_a_row_;
  left_.include(entry.error);
}

float FromScratch::forced_weight(const Entry& entry, const Cut::Closure& closure) {
  if (closure.splits.size() == 1) return 1.0F;
  const float weight = scene_.importances[entry.object].forced_weight(closure.splits);
  if (weight == 1.0F) return weight;
  needed_.clear();
  for (const SplitId needed : star_of(scene_.hierarchy(entry.object), entry.split).dependencies())
    if (!(*scene_.cuts)[entry.object].applied(needed)) needed_.push_back(needed);
  waiting_.wait(entry, needed_);
  return weight;
}

// Takes back the least important leaf if it matters less, in the final check only. The leaf may come back.
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
    queues_.push(
        {victim->priority, victim->error, victim->split, victim->object, 0, entries_.occluder(), Entry::Kind::apply});
  return true;
}

void FromScratch::apply_closure(const Entry& entry, const Cut::Closure& closure) {
  rejections_in_a_row_ = 0;
  entries_.steps().split_applied(entry.error.quadric_px);
  stats_->splits += closure.splits.size();
  const bool by_star = tuning_of(*scene_.options).culling == Culling::star;
  for (const SplitId s : closure.splits.subspan(1))
    forced_.push_back({entry.object, s, by_star && scene_.importances[entry.object].visible_share(s) == 0.0F});
  waiting_.wake(entry.object, closure.splits, woken_);
  scene_.cuts->apply_closure(entry.object);
}

Growth FromScratch::growth() const {
  return {stats_->splits, scene_.cuts->triangle_count() - scene_.cuts->base_triangle_count()};
}

// Returns whether the mesh has reached the next step at which it is drawn.
bool FromScratch::step_due() { return scene_.queries->can_hide() && !level_ && entries_.steps().due(growth()); }

// Returns true at a step, and when everything left is hidden by an occluder that has since been refined.
bool FromScratch::occluder_due() {
  if (step_due()) return true;
  return scene_.queries->can_hide() && !level_ && tuning_of(*scene_.options).retest_hidden && queues_.empty() &&
         !hidden().empty() && stats_->splits > entries_.steps().last().splits;
}

}  // namespace occlod
