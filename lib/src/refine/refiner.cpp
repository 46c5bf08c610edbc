#include "occlod/refine/refiner.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "cut.h"
#include "effect_gate.h"
#include "frames.h"
#include "importance.h"
#include "milliseconds_since.h"
#include "occlod/core/error.h"
#include "occluder.h"
#include "occluder_steps.h"
#include "query_shape.h"
#include "questions.h"
#include "queue.h"
#include "star.h"
#include "victims.h"

namespace occlod {
namespace {

// When so many visible splits in a row need more triangles than are left, the budget counts as used up.
constexpr std::size_t most_rejections_in_a_row = 64;

// Whether a cut that was refined with one can be gone on with by the other.
bool go_on_alike(const RefineOptions& a, RefineOptions b) {
  b.budget = a.budget;
  b.tolerance_px = a.tolerance_px;
  b.hysteresis = a.hysteresis;
  b.most_changes = a.most_changes;
  b.time_limit_ms = a.time_limit_ms;
  b.geomorph_frames = a.geomorph_frames;
  return a == b;
}

}  // namespace

// One refinement, from the base meshes to the end of the budget:
//   while there is something that may matter: take the worst; ask whether it is seen; descend below it, or apply it.
// (Birkholz & Rahn, sec. 3.2 and 3.3.) Deviations: nodes are asked about when their turn comes rather than when they
// are found, so that nothing is spent on those whose turn never comes, except that children of a visible node go
// straight into a flight that has room; with Culling::star a node is descended and applied by separate questions, and a
// split waits for as long as what it forces is not worth it; and what is hidden at the end is asked about once more.
class Refiner::Impl {
 public:
  explicit Impl(std::span<const RefineObject> objects) : objects_(objects.begin(), objects.end()) {
    for (const RefineObject& object : objects_) {
      if (object.hierarchy == nullptr)
        throw Error({"refiner", "object " + std::to_string(cuts_.size()), "has no hierarchy", "build one first"});
      cuts_.emplace_back(*object.hierarchy);
      importances_.emplace_back(object);
    }
    result_.objects.resize(objects_.size());
    base_triangles_ = sum(&Hierarchy::base_triangle_count);
  }

  [[nodiscard]] std::size_t base_triangles() const noexcept { return base_triangles_; }
  [[nodiscard]] std::size_t full_triangles() const noexcept { return sum(&Hierarchy::input_triangle_count); }

  const Refinement& refine(const View& view, const RefineOptions& options, Visibility& visibility) {
    const Clock::time_point start = Clock::now();
    begin(view, options, visibility);
    frames_.reset();
    refine_from_scratch();
    emit();
    finish(start);
    return result_;
  }

  const Refinement& update(const View& view, const RefineOptions& options, Visibility& visibility) {
    const Clock::time_point start = Clock::now();
    const bool moved = !last_ || last_->visibility != &visibility || last_->camera != view.camera();
    if (frames_ && !moved && options_ == options && frames_->at_rest()) return repeat(start);
    const bool same_backend = last_ && last_->visibility == &visibility;
    if (!go_on_alike(options_, options)) frames_.reset();
    begin(view, options, visibility);
    last_ = {view.camera(), &visibility};
    if (frames_ && !same_backend) frames_->forget_hidden();
    const bool limited = options.most_changes > 0 || options.time_limit_ms > 0.0;
    const RefinedCuts refined{objects_, cuts_, views_, importances_, &gate_};
    if (frames_ && (frames_->weigh(refined, options_) || limited)) {
      frames_->advance(questions_, occluder_mesh_, moved, start, stats_);
    } else {
      refine_from_scratch();
      if (!frames_) frames_.emplace(objects_);
      frames_->adopt(refined, options_, end_level_, hidden_);
    }
    for (std::uint32_t i = 0; i < objects_.size(); ++i) frames_->emit(i, result_.objects[i], stats_);
    stats_.splits = 0;
    for (const RefinedObject& object : result_.objects) stats_.splits += object.splits.size();
    finish(start);
    return result_;
  }

 private:
  [[nodiscard]] std::size_t sum(std::size_t (Hierarchy::*count)() const noexcept) const noexcept {
    std::size_t total = 0;
    for (const RefineObject& object : objects_) total += (object.hierarchy->*count)();
    return total;
  }

  void begin(const View& view, const RefineOptions& options, Visibility& visibility) {
    if (options.budget < base_triangles())
      throw Error({"budget", "", "of " + std::to_string(options.budget) + " triangles is smaller than the base meshes",
                   "give at least " + std::to_string(base_triangles())});
    options_ = options;
    views_.clear();
    for (const RefineObject& object : objects_) views_.emplace_back(view, object.object_to_world);
    for (std::size_t i = 0; i < objects_.size(); ++i) importances_[i].begin(views_[i], options_);
    questions_.begin(visibility, view, views_);
    gate_.begin(objects_, options_);
    stats_ = {};
    stats_.budget = options.budget;
  }

  void refine_from_scratch() {
    for (Cut& cut : cuts_) cut.clear();
    steps_.begin(options_);
    queue_.clear();
    hidden_.clear();
    victims_.clear();
    triangles_ = base_triangles();
    occluder_ = 0;
    rejections_in_a_row_ = 0;
    left_ = {};
    level_.reset();
    for (std::uint32_t i = 0; i < objects_.size(); ++i)
      for (const SplitId root : cuts_[i].hierarchy().data().roots) meet(i, root, no_id, 0);
    run();
    end_level_ = queue_.empty() ? 0.0F : queue_.top().priority;
    stats_.level_px = static_cast<double>(end_level_);
    if (options_.final_check) readmit();
    stats_.triangles = triangles_;
    stats_.culled_occlusion = hidden_.size();
    queue_.for_each([&](const Entry& entry) {
      if (!cuts_[entry.object].applied(entry.split)) left_.include(entry.error);
    });
    stats_.max_error_px = static_cast<double>(left_.guaranteed_px);
    stats_.max_quadric_error_px = static_cast<double>(left_.quadric_px);
  }

  void run() {
    while (!used_up()) {
      if (occluder_due()) {
        drain();
        draw_occluder();
      }
      // Top the flight up from the global queue.
      while (!queue_.empty() && questions_.has_room() && matters(queue_.top()) && must_ask(queue_.top()))
        ask(queue_.pop());
      const bool anything = !queue_.empty() && matters(queue_.top());
      if (!questions_.none_open() && (!anything || !questions_.has_room())) {
        settle();
      } else if (anything) {
        process(queue_.pop());
      } else {
        break;
      }
    }
    drain();
  }

  [[nodiscard]] bool used_up() const {
    if (rejections_in_a_row_ >= most_rejections_in_a_row) return true;
    if (level_) return questions_.none_open() && (queue_.empty() || !matters(queue_.top()));
    return triangles_ >= options_.budget;
  }

  // When the budget is used up, only what matters more than what it went to.
  [[nodiscard]] bool matters(const Entry& entry) const { return !level_ || entry.priority > *level_; }

  // What earlier occluders hid is asked about once more, before the mesh as it is now. What this mesh shows takes the
  // place of what matters less.
  void readmit() {
    if (occluder_ == 0 || hidden_.empty() || stats_.splits == steps_.last().splits) return;
    level_ = queue_.empty() ? 0.0F : queue_.top().priority;
    rejections_in_a_row_ = 0;
    doubtful_.swap(hidden_);
    draw_occluder();
    for (const Entry& entry : doubtful_) {
      if (!questions_.has_room()) settle_later();
      doubt(entry);
      ask(entry);
    }
    drain();
    stats_.readmitted = doubtful_.size() - hidden_.size();
    doubtful_.clear();
    run();
  }

  // A node comes into sight of the refinement: dropped for good, or offered.
  void meet(std::uint32_t object, SplitId s, SplitId parent, std::uint32_t level) {
    const Hierarchy& hierarchy = cuts_[object].hierarchy();
    hierarchy.require(s);
    const SplitNode& node = hierarchy.node(s);
    if (node.parent != parent)  // else a file that lies about its forest could be walked without an end
      throw Error({"hierarchy", "split " + std::to_string(s), "is not where its parent says", "build it again"});
    const ObjectView& view = views_[object];
    ++stats_.visits;
    if (!view.may_be_inside(node.sphere)) {
      ++stats_.culled_frustum;
      return;
    }
    if (faces_away(node, object)) {
      ++stats_.culled_backface;
      return;
    }
    const ScreenError error(node, view.largest_scale_px(node.sphere));
    if (is_tolerated(error)) return;
    offer({error.quadric_px, error, s, object, level, 0, Entry::Kind::visit});
  }

  // Small enough to be left as it is, and noted as such.
  bool is_tolerated(const ScreenError& error) {
    if (!(options_.tolerance_px > 0.0 && error.guaranteed_px <= static_cast<float>(options_.tolerance_px)))
      return false;
    left_.include(error);
    return true;
  }

  [[nodiscard]] bool faces_away(const SplitNode& node, std::uint32_t object) {
    return gate_.tests_cone(object) &&
           gate_.cone_culled(object, occlod::faces_away(node.cone(), node.sphere, views_[object].eye()));
  }

  // Into the flight if it has room for a question that must be asked, else into the global queue.
  void offer(const Entry& entry) {
    if (questions_.in_flights() && questions_.has_room() && matters(entry) && must_ask(entry))
      ask(entry);
    else
      queue_.push(entry);
  }

  [[nodiscard]] bool must_ask(const Entry& entry) const {
    if (occluder_ == 0 || entry.asked_occluder == occluder_) return false;
    if (!gate_.asks(entry.object, cuts_[entry.object].hierarchy().node(entry.split).sphere.center)) return false;
    if (entry.kind == Entry::Kind::apply) return options_.ask_stars;
    return entry.level % options_.level_step == options_.level_step - 1;
  }

  void ask(const Entry& entry) {
    questions_.ask(entry, query_about(entry, cuts_[entry.object].hierarchy(), options_.proxy, star_));
    ++stats_.queries;
  }

  // Takes the oldest answer; what is visible is processed if its turn is still now.
  void settle() {
    const Entry entry = take_answer();
    if (entry.split == no_id) return;
    if (matters(entry) && queue_.would_be_next(entry))
      process(entry);
    else
      queue_.push(entry);
  }

  // Takes all answers that are still under way, without acting on them.
  void drain() {
    while (!questions_.none_open()) settle_later();
  }
  void settle_later() {
    const Entry entry = take_answer();
    if (entry.split != no_id) queue_.push(entry);
  }

  // The oldest entry asked about, if it is visible; else it joins the hidden ones and no entry comes back.
  Entry take_answer() {
    Questions::Answer answer = questions_.take();
    gate_.answered(answer.entry, cuts_[answer.entry.object].hierarchy().node(answer.entry.split), answer.visible);
    if (!answer.visible) {
      ++stats_.queries_hidden;
      hidden_.push_back(answer.entry);
      if (answer.entry.kind == Entry::Kind::apply)
        importances_[answer.entry.object].set_hidden(answer.entry.split, true);
      return {};
    }
    answer.entry.asked_occluder = occluder_;
    return answer.entry;
  }

  [[nodiscard]] Growth growth() const { return {stats_.splits, triangles_ - base_triangles_}; }

  // At its step, and when all that is left is hidden by an occluder that has since been refined.
  [[nodiscard]] bool occluder_due() const {
    if (!questions_.can_hide() || level_) return false;
    if (steps_.due(growth())) return true;
    return options_.retest_hidden && queue_.empty() && questions_.none_open() && !hidden_.empty() &&
           stats_.splits > steps_.last().splits;
  }

  void draw_occluder() {
    questions_.draw_occluder(occluder_mesh_.build(objects_, cuts_, views_, options_.occluder_mode));
    steps_.drawn(growth());
    ++occluder_;
    ++stats_.occluder_draws;
    if (!options_.retest_hidden) return;
    for (const Entry& entry : hidden_) {  // (sec. 3.2)
      doubt(entry);
      queue_.push(entry);
    }
    hidden_.clear();
  }

  // An older occluder hid it: that is no longer held to be true.
  void doubt(const Entry& entry) {
    if (entry.kind == Entry::Kind::apply) importances_[entry.object].set_hidden(entry.split, false);
  }

  // An entry that is visible as far as we know.
  void process(const Entry& entry) {
    if (entry.kind == Entry::Kind::visit) {
      const SplitNode& node = cuts_[entry.object].hierarchy().node(entry.split);
      if (options_.culling == Culling::subtree)
        apply(entry);
      else
        consider(entry);
      for (const SplitId child : {node.child_u, node.child_v})
        if (child != no_id) meet(entry.object, child, entry.split, entry.level + 1);
    } else {
      apply(entry);
    }
  }

  // Culling::star: does the split itself change anything that is seen, and how much of what it changes?
  void consider(const Entry& entry) {
    if (cuts_[entry.object].applied(entry.split)) return;
    const Importance::Value value = importances_[entry.object].of(entry.split);
    if (value.visible_share == 0.0F) {
      ++stats_.culled_backface;
      return;
    }
    if (is_tolerated(value.error)) return;
    offer({value.priority, value.error, entry.split, entry.object, entry.level, 0, Entry::Kind::apply});
  }

  void apply(const Entry& entry) {
    Cut& cut = cuts_[entry.object];
    if (cut.applied(entry.split)) return;
    Cut::Closure closure = cut.closure(entry.split);
    if (waits(entry, closure)) return;
    while (triangles_ + closure.triangles > options_.budget) {
      if (!make_room(entry)) {
        ++stats_.rejected_splits;
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
  bool waits(const Entry& entry, const Cut::Closure& closure) {
    if (options_.culling != Culling::star || entry.weighed || closure.splits.size() == 1) return false;
    Entry later = entry;
    later.weighed = true;
    later.priority *= importances_[entry.object].forced_weight(closure.splits);
    if (queue_.would_be_next(later)) return false;
    queue_.push(later);
    return true;
  }

  // After the final check: gives up the least important leaf, if it matters less than `entry`. It may come back.
  bool make_room(const Entry& entry) {
    if (!level_) return false;
    if (!victims_.gathered()) victims_.gather(cuts_, importances_);
    const std::optional<Victims::Victim> victim = victims_.take_back_below(entry.priority, cuts_, importances_);
    if (!victim) return false;
    triangles_ -= victim->triangles;
    --stats_.splits;
    ++stats_.taken_back;
    if (victim->priority > 0.0F)
      queue_.push({victim->priority, victim->error, victim->split, victim->object, 0, occluder_, Entry::Kind::apply});
    return true;
  }

  void count_splits(const Entry& entry, const Cut::Closure& closure) {
    steps_.split_applied(entry.error.quadric_px);
    stats_.splits += closure.splits.size();
    stats_.forced_splits += closure.splits.size() - 1;
    if (options_.culling != Culling::star) return;
    for (const SplitId s : closure.splits.subspan(1))
      if (importances_[entry.object].visible_share(s) == 0.0F) ++stats_.forced_unseen_splits;
  }

  void emit() {
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
      RefinedObject& object = result_.objects[i];
      cuts_[i].active_triangles(object.triangles, true);
      object.splits.assign(cuts_[i].applied_splits().begin(), cuts_[i].applied_splits().end());
      object.changes.assign(1, {0, static_cast<std::uint32_t>(object.triangles.size())});
      object.geomorphs.clear();
    }
    stats_.new_splits = stats_.splits;
    stats_.changed_triangles = triangles_;
  }

  // Nothing has changed since the call before.
  const Refinement& repeat(Clock::time_point start) {
    for (RefinedObject& object : result_.objects) object.changes.clear();
    stats_ = result_.stats;
    stats_.new_splits = stats_.merged_splits = stats_.forced_splits = stats_.changed_triangles = 0;
    stats_.visits = stats_.queries = stats_.queries_hidden = stats_.occluder_draws = 0;
    stats_.rejected_splits = stats_.readmitted = stats_.taken_back = 0;
    stats_.occlusion_ms = 0.0;
    stats_.refine_ms = milliseconds_since(start);
    result_.stats = stats_;
    return result_;
  }

  void finish(Clock::time_point start) {
    stats_.occlusion_ms = questions_.milliseconds();
    stats_.refine_ms = milliseconds_since(start) - stats_.occlusion_ms;
    result_.stats = stats_;
    result_.effects.assign(gate_.stats().begin(), gate_.stats().end());
  }

  std::vector<RefineObject> objects_;
  std::vector<Cut> cuts_;
  std::vector<ObjectView> views_;
  std::vector<Importance> importances_;
  RefineOptions options_;
  Questions questions_;
  OccluderSteps steps_;
  EffectGate gate_;
  Queue queue_;
  std::vector<Entry> hidden_;    // found hidden by the occluder of their time
  std::vector<Entry> doubtful_;  // found hidden by earlier occluders than that before which they are now asked about
  Occluder occluder_mesh_;
  StarLook star_;
  Victims victims_;
  std::size_t base_triangles_ = 0;
  std::size_t triangles_ = 0;   // of all cuts
  std::uint32_t occluder_ = 0;  // how many have been drawn
  std::size_t rejections_in_a_row_ = 0;
  std::optional<float> level_;  // of priorities, where the budget ended: set when what was hidden is checked
  ScreenError left_;            // the largest of what is held to be visible and is not refined
  RefineStats stats_;
  Refinement result_;

  struct Last {
    Camera camera;
    const Visibility* visibility;  // only compared
  };
  std::optional<Last> last_;      // of update()
  float end_level_ = 0.0F;        // the priority where the budget ended, before the final check
  std::optional<Frames> frames_;  // of update(), since the last refine()
};

const Refinement& Refiner::update(const View& view, const RefineOptions& options, Visibility& visibility) {
  return impl_->update(view, options, visibility);
}

Refiner::Refiner(std::span<const RefineObject> objects) : impl_(std::make_unique<Impl>(objects)) {}
Refiner::~Refiner() = default;
Refiner::Refiner(Refiner&&) noexcept = default;
Refiner& Refiner::operator=(Refiner&&) noexcept = default;

std::size_t Refiner::base_triangles() const noexcept { return impl_->base_triangles(); }
std::size_t Refiner::full_triangles() const noexcept { return impl_->full_triangles(); }

const Refinement& Refiner::refine(const View& view, const RefineOptions& options, Visibility& visibility) {
  return impl_->refine(view, options, visibility);
}

}  // namespace occlod
