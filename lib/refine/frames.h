// Refinement that goes on from the frame before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/timing.h"
#include "occlod/refiner.h"
#include "refine/cut.h"
#include "refine/drawn_mesh.h"
#include "refine/front_evaluation.h"
#include "refine/queue.h"
#include "refine/refined_scene.h"

namespace occlod {

// How fronts grow and shrink along the forest.

// A node is reached when it is a root or its parent has been descended; on a front is what is reached or applied.
class FrontForest {
 public:
  explicit FrontForest(FrontEvaluation& evaluation) : evaluation_(evaluation) {}

  // What refinement from scratch has applied, on an empty front.
  void adopt_splits(std::uint32_t object);
  // Then, where what is hidden is marked: descends from the roots to what matters no more than `level`.
  void adopt_forest(std::uint32_t object, float level);

  // Reaches the children of s and evaluates them; the result is valid until the next call. Throws Error for a file that
  // lies about its forest.
  std::span<const Front::Index> descend(std::uint32_t object, SplitId s);
  // Gives up descending nodes that are hidden or whose errors are no larger than `least`.
  void close(std::uint32_t object, float least);

 private:
  void reach(std::uint32_t object, SplitId s, SplitId parent, std::uint16_t level);
  void reach_children(std::uint32_t object, SplitId s);
  [[nodiscard]] bool is_closable(const Front& front, Front::Index k, float least) const;
  bool close_one(std::uint32_t object, SplitId s, float least);

  FrontEvaluation& evaluation_;
  std::vector<Front::Index> reached_, found_;
  std::vector<SplitId> open_, level_;  // scratch
};

// What a frame asks about occlusion, and what is known of it from frames before.

// Of what is asked again, one in so many is asked about in each frame.
inline constexpr std::uint32_t asking_rounds = 2;

// A node on a front is marked as hidden as long as the last answer about it said so and the options would still let it
// be asked about.
class FrontQueries {
 public:
  explicit FrontQueries(FrontEvaluation& evaluation) : evaluation_(evaluation) {}

  // After refinement from scratch, which found this hidden.
  void adopt(std::span<const Entry> hidden);
  // Of frames that go on. `frame`: its number. `moved`: answers from frames before are out of date.
  void begin_frame(std::uint32_t frame, bool moved);
  // Nothing that has been answered before holds any more.
  void forget_hidden();

  // Draws an occluder, then asks about hidden things that would matter; so is a rotating share of what the budget has
  // been spent on. What is met for the first time is asked about when its turn comes. `level`: the priority where the
  // budget ended. Returns how many hidden things are shown now.
  std::size_t ask_again(float level);
  // Draws an occluder, then asks about hidden things that would matter. Returns those that are shown now; valid until
  // the next question.
  std::span<const Entry> check_hidden(float level);
  // Whether the occluder of this frame hides it: asked now, unless it has been.
  [[nodiscard]] bool is_hidden(const Entry& entry);
  // When a split has become a leaf. What this view has shown is not asked about again.
  void ask_about_new_leaf(std::uint32_t object, Front::Index k);

  // Of applied splits of one object: see Refiner::visibility_ages().
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::uint32_t object, std::span<const SplitId> splits) const;

 private:
  void forget_what_is_not_asked(std::uint32_t object);
  void ask_about(std::uint32_t object, Front::Index k, Entry::Kind kind);
  void ask_about_hidden(std::uint32_t object, float least);
  void ask_about_unapplied(std::uint32_t object, float least);
  void ask_about_leaves(std::uint32_t object);
  [[nodiscard]] bool is_shown_since(std::uint32_t draw, const FrontNode& node, Entry::Kind kind) const;
  void draw_occluder();
  // Asks all of asked_, and keeps those there that are shown now and were hidden before.
  void ask_all();
  bool note(const Entry& entry, bool visible);
  [[nodiscard]] float min_error(float level) const;

  FrontEvaluation& evaluation_;
  std::uint32_t frame_ = 0;
  std::uint32_t draw_ = 0;          // occluders so far
  std::uint32_t adopted_draw_ = 0;  // the last of them before the cut was taken over
  std::uint32_t fresh_draw_ = 0;    // verdicts before earlier ones are out of date
  std::vector<Entry> asked_;        // scratch, all of them
  std::vector<OcclusionQueries::Verdict> verdicts_;
  std::vector<Front::Index> found_;
};

// What nobody sees of the cut, and is applied all the same because something else needs it.

// A split is charged, as far as its star is not seen, to those that remove faces of it, with what it needs itself: what
// removes a part f of its removed faces pays sqrt(f) of it. Were it f, several leaves would keep for good what none of
// them is worth; were it all, what is needed most would cost the most.
class UnseenNeeds {
 public:
  explicit UnseenNeeds(FrontEvaluation& evaluation) : evaluation_(evaluation) {}

  void begin_frame(std::uint32_t frame) noexcept { frame_ = frame; }

  // The factor by which the priority of an applied split sinks, in (0, 1]. O(what it needs directly), as what those
  // are charged with is known for some frames.
  [[nodiscard]] float weight_of_applied(std::uint32_t object, SplitId s);
  // Of closure.splits[0] once the closure is applied. O(closure).
  [[nodiscard]] float weight_of_closure(std::uint32_t object, const Cut::Closure& closure);

 private:
  // All of these count splits.
  [[nodiscard]] float needed_by(std::uint32_t object, SplitId s, int depth);
  [[nodiscard]] float needed_by_unapplied(std::uint32_t object, SplitId s);
  [[nodiscard]] float charge(std::uint32_t object, SplitId s, std::uint32_t own, std::uint32_t removed, int depth);
  [[nodiscard]] float below(std::uint32_t object, Front::Index k, int depth);
  [[nodiscard]] float unseen_part(std::uint32_t object, SplitId s);
  [[nodiscard]] float weight(float unseen) const;

  FrontEvaluation& evaluation_;
  std::uint32_t frame_ = 0;
};

// Which splits of the frame before give way to which others.

// What a split forces, and what a leaf keeps, is looked at again in one frame of so many.
inline constexpr std::uint32_t weighing_rounds = 8;

// By how much the level may sink in the first frame after refinement from scratch.
inline constexpr float first_settling_step = 1.06F;

// Worst first, candidates are descended or applied, and take the place of applied leaves that matter less (the dual
// queues of Duchaineau et al., ROAMing Terrain, 1997, here over the dependencies of splits). The priority where the
// budget ended is kept: only what is near it is queued, and more when that does not suffice. Cuts, fronts and drawn
// meshes have the same splits before and after each exchange.
class SplitExchange {
 public:
  // These outlive it.
  SplitExchange(FrontEvaluation& evaluation, FrontForest& forest, FrontQueries& queries, std::span<DrawnMesh> meshes);

  // After refinement from scratch, which came to the end of the budget at this priority.
  void adopt(float level) noexcept {
    level_ = adopted_level_ = settling_level_ = level;
    settling_step_ = first_settling_step;
  }
  // Of frames that go on. `frame`: its number; `start`: when time_limit_ms begins.
  void begin_frame(std::uint32_t frame, Clock::time_point start, RefineStats& stats);

  // Until no candidate matters more than what is applied, or the budget or a limit ends it.
  void run();
  // As run(), after it: goes on with these, which have turned out to be visible.
  void run_on(std::span<const Entry> shown);
  // Where the budget is enough: takes back leaves that nobody sees, or that are well within the tolerance.
  void take_back_needless();

  // The priority where the budget ended.
  [[nodiscard]] float level() const noexcept { return level_; }
  // Whether nothing is left to later frames because refinement from scratch is not long ago.
  [[nodiscard]] bool has_settled() const noexcept { return settling_level_ == 0.0F; }
  // Splits and merges in this frame.
  [[nodiscard]] std::size_t changes() const noexcept { return changes_; }
  // The largest error of what found no room.
  [[nodiscard]] const ScreenError& rejected_error() const noexcept { return rejected_; }

  // For apply_split().
  [[nodiscard]] float forced_weight(const Entry& entry, const Cut::Closure& closure);
  bool step_back(const Entry& entry);
  bool make_room(float turn_priority, float priority);
  void apply_closure(const Entry& entry, const Cut::Closure& closure);

 private:
  void gather();
  void gather_candidates(float low, float high);
  [[nodiscard]] bool weighs_again(const Front& front, Front::Index k) const;
  void leave_out_low(std::uint32_t object, float low);
  void gather_more_candidates();
  [[nodiscard]] bool waits_for_later_frames() const;
  void gather_leaves(float low, float high);
  bool gather_more_leaves();
  void weigh_leaves(std::uint32_t object);
  void weigh_leaf(std::uint32_t object, Front::Index k);

  void exchange();
  [[nodiscard]] bool limit_reached() const;
  void descend(const Entry& entry);
  void enqueue_visit(std::uint32_t object, Front::Index k);
  void enqueue_split(std::uint32_t object, Front::Index k);
  void note_forced(const Entry& entry, const Cut::Closure& closure);
  bool take_back_least();
  void take_back(std::uint32_t object, SplitId s);
  void enqueue_new_leaf(std::uint32_t object, SplitId s);
  void enqueue_leaf(std::uint32_t object, SplitId s, float priority);
  [[nodiscard]] float leaf_priority(std::uint32_t object, Front::Index k);
  [[nodiscard]] bool is_old_leaf(const Entry& leaf) const;

  FrontEvaluation& evaluation_;
  FrontForest& forest_;
  FrontQueries& queries_;
  std::span<DrawnMesh> meshes_;
  RefineStats* stats_ = nullptr;
  Clock::time_point start_;
  std::uint32_t frame_ = 0;
  float level_ = 0.0F;
  float adopted_level_ = 0.0F, settling_step_ = 1.0F;
  float settling_level_ = 0.0F;  // what matters less is left to later frames, while the budget is used up
  Queue candidates_;
  Queue leaves_;                   // by 1 / priority
  float candidates_above_ = 0.0F;  // queued are candidates with larger priorities
  float last_step_ = 0.0F;         // below which all the others are queued
  float leaves_below_ = 0.0F;      // and leaves with smaller ones
  std::size_t changes_ = 0;
  ScreenError rejected_;
  UnseenNeeds unseen_needs_;
  std::vector<Front::Index> found_;  // scratch
  std::vector<SplitId> sorted_;
};

// Refinement that goes on from the frame before.

// One frame:
//   evaluate the front in the new view, as far as what is known of it has expired or matters;
//   ask again about what is hidden, and about a part of what is applied;
//   exchange splits, worst candidates first;
//   check what is hidden against the mesh that has come about, where such checks have been of use lately.
// The nodes are about twice as many as applied splits and are looked through in vectors; what is evaluated and queued
// is in proportion to what changes.
class Frames {
 public:
  // Keeps the triangles of the objects in `result`, which outlives it.
  Frames(std::span<const RefineObject> objects, std::span<RefinedObject> result);
  Frames(const Frames&) = delete;
  Frames& operator=(const Frames&) = delete;

  // Takes over cuts that refinement from scratch has made: `level` is the priority where the budget ended, `hidden`
  // what was hidden at the end. The scene outlives the frame.
  void adopt(const RefinedScene& scene, float level, std::span<const Entry> hidden);

  // Evaluates the front in a new view. False when a quarter of the cut has become worth little: then it is better to
  // start from scratch. Options that differ from those of the frame before are no reason to.
  [[nodiscard]] bool move_to(const RefinedScene& scene);
  // After move_to(). `moved`: the view, or what the backend would answer, differs from that of the frame before.
  void advance(bool moved, Clock::time_point start, RefineStats& stats);
  void forget_hidden() { queries_.forget_hidden(); }

  // After adopt() or advance(), into what the frame before got.
  void emit(std::span<RefinedObject> out, RefineStats& stats);
  // Of applied splits of one object: see Refiner::visibility_ages().
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::uint32_t object,
                                                           std::span<const SplitId> splits) const {
    return queries_.visibility_ages(object, splits);
  }
  // The next frame will change nothing unless the view or the options do.
  [[nodiscard]] bool at_rest() const noexcept { return at_rest_; }

 private:
  void begin();
  void exchange_splits(bool moved, RefineStats& stats);
  void note_check(std::span<const Entry> shown);
  void measure(RefineStats& stats);

  FrontEvaluation evaluation_;
  FrontForest forest_;
  FrontQueries queries_;
  std::vector<DrawnMesh> meshes_;
  SplitExchange exchange_;
  std::uint32_t frame_ = 0;
  std::uint32_t moved_frame_ = 0;  // in which the view moved last
  AppliedCount before_;            // when the last frame ended
  std::uint32_t same_frames_ = 0;  // in a row that have ended with the mesh that they began with, in one view
  // Of what is hidden, by the mesh of the frame itself: how many, from the last that found something that matters on.
  std::uint32_t checks_since_useful_ = 0;
  bool at_rest_ = false;
};

}  // namespace occlod
