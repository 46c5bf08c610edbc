// Refines from frame to frame by exchanging splits of the cut of the frame before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
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

// Grows and shrinks fronts. A node is reached when it is a root or its parent has been descended; a front holds what is
// reached or applied.
class FrontForest {
 public:
  explicit FrontForest(FrontEvaluation& evaluation) : evaluation_(evaluation) {}

  // Adds what refinement from scratch has applied to an empty front.
  void adopt_splits(std::uint32_t object);
  // Descends from the roots to nodes that matter no more than `level`. Call it after adopt_splits(), when hidden nodes
  // are marked.
  void adopt_forest(std::uint32_t object, float level);

  // Reaches the children of these splits and evaluates them; the result is valid until the next call. Throws Error when
  // the forest in the file is inconsistent.
  std::span<const Front::Index> descend(std::uint32_t object, std::span<const SplitId> splits);
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

// Each frame asks again about one in this many leaves.
inline constexpr std::uint32_t asking_rounds = 2;

// Asks about the nodes of fronts and keeps the answers from frame to frame. A node is marked as hidden as long as the
// last answer about it said so and the options still let it be asked about.
class FrontQueries {
 public:
  explicit FrontQueries(FrontEvaluation& evaluation) : evaluation_(evaluation) {}

  // Takes over what refinement from scratch found hidden.
  void adopt(std::span<const Entry> hidden);
  // Starts a frame that goes on from the one before. `frame` is its number; `moved`: earlier answers are out of date.
  void begin_frame(std::uint32_t frame, bool moved);
  // Unmarks all hidden and covered nodes, because no earlier answer holds any more.
  void forget_hidden();

  // Looks at the occluder, then asks about hidden nodes that would matter and about a rotating share of the leaves.
  // What is met for the first time is asked about when its turn comes. `level` is the priority at which the budget
  // ended. Returns how many hidden nodes are shown now.
  std::size_t ask_again(float level);
  // Draws an occluder, then asks about hidden nodes whose errors exceed `least`, in pixels. Returns those that are
  // shown now; valid until the next question.
  std::span<const Entry> check_hidden(float least);
  // Removes entries that the occluder of this frame hides. Asks about those that it has not been asked about, at once.
  void drop_hidden(std::vector<Entry>& entries);
  // Returns a number that is larger than 0 and changes whenever an occluder is drawn.
  [[nodiscard]] std::uint32_t occluder() const noexcept { return draw_ + 1; }
  // Asks about a split that has become a leaf, unless this view has shown it.
  void ask_about_new_leaf(std::uint32_t object, Front::Index k);

  // Returns the ages of applied splits of one object: see Refiner::visibility_ages().
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::uint32_t object, std::span<const SplitId> splits) const;

 private:
  void forget_what_is_not_asked(std::uint32_t object);
  void ask_about(std::uint32_t object, Front::Index k, Entry::Kind kind);
  bool ask_unless_asked(std::span<const Entry> entries);
  void ask_about_hidden(std::uint32_t object, float least);
  void ask_about_unapplied(std::uint32_t object, float least);
  void ask_about_leaves(std::uint32_t object);
  [[nodiscard]] bool is_shown_since(std::uint32_t draw, const FrontNode& node, Entry::Kind kind) const;
  void begin_questions();
  // Asks all of asked_, and keeps those there that are shown now and were hidden before.
  void ask_all();
  void set_covered(Front& front, Front::Index k, bool covered) const;
  bool note(const Entry& entry, const OcclusionQueries::Verdict& verdict);
  [[nodiscard]] float min_error(float level) const;

  FrontEvaluation& evaluation_;
  std::uint32_t frame_ = 0;
  std::uint32_t draw_ = 0;          // occluders drawn so far
  std::uint32_t adopted_draw_ = 0;  // draw_ when the cut was taken over
  std::uint32_t fresh_draw_ = 0;    // answers with earlier occluders are out of date
  std::vector<Entry> asked_;        // scratch, like the next two
  std::vector<OcclusionQueries::Verdict> verdicts_;
  std::vector<Front::Index> found_;
};

// Charges splits for unseen ones that they need. As far as the star of a split is not seen, the split and what it needs
// itself are charged to those that remove its faces: one that removes a part f of its removed faces pays sqrt(f). If it
// paid f, several leaves would keep for good what none of them is worth; if it paid all, what is needed most would cost
// the most.
class UnseenNeeds {
 public:
  explicit UnseenNeeds(FrontEvaluation& evaluation) : evaluation_(evaluation) {}

  void begin_frame(std::uint32_t frame) noexcept { frame_ = frame; }

  // Finds what is seen of all that these splits need, on as many threads as the options allow. The weights below are
  // the same without this, but take longer.
  void look_at_needs(std::uint32_t object, std::span<const SplitId> splits, std::span<const SplitId> forced);

  // Returns the factor by which the priority of an applied split sinks, also because its vertex is covered, in (0, 1].
  // O(direct dependencies), because their charges are kept for some frames.
  [[nodiscard]] float weight_of_applied(std::uint32_t object, SplitId s);
  // Returns the factor of closure.splits[0] once the closure is applied. O(closure).
  [[nodiscard]] float weight_of_closure(std::uint32_t object, const Cut::Closure& closure);

 private:
  // These return numbers of splits, except weight(), which returns a factor.
  [[nodiscard]] float needed_by(std::uint32_t object, SplitId s, int depth);
  [[nodiscard]] float needed_by_unapplied(std::uint32_t object, SplitId s);
  [[nodiscard]] float charge(std::uint32_t object, SplitId s, std::uint32_t own, std::uint32_t removed, int depth);
  [[nodiscard]] float below(std::uint32_t object, Front::Index k, int depth);
  [[nodiscard]] float unseen_part(std::uint32_t object, SplitId s);
  [[nodiscard]] float weight(std::uint32_t object, SplitId s, float unseen) const;

  FrontEvaluation& evaluation_;
  std::uint32_t frame_ = 0;
  std::vector<Front::Index> outdated_;  // scratch, like the next one
  std::vector<SplitWorth> worths_;
};

// What a split forces, and what a leaf keeps, is weighed again once in this many frames.
inline constexpr std::uint32_t weighing_rounds = 8;

// Factor by which the level may sink in the first frame after refinement from scratch.
inline constexpr float first_settling_step = 1.06F;

// Descends or applies candidates, worst first, in place of applied leaves that matter less (the dual queues of
// Duchaineau et al., ROAMing Terrain, 1997, here over the dependencies of splits). The priority at which the budget
// ended is kept: only what is near it is queued, and more when that does not suffice. Cuts, fronts and drawn meshes
// have the same splits before and after each exchange.
class SplitExchange {
 public:
  // All arguments must outlive this object.
  SplitExchange(FrontEvaluation& evaluation, FrontForest& forest, FrontQueries& queries, std::span<DrawnMesh> meshes);

  // Takes over from refinement from scratch, whose budget ended at this priority.
  void adopt(float level) noexcept {
    level_ = adopted_level_ = settling_level_ = level;
    settling_step_ = first_settling_step;
  }
  // Starts a frame that goes on from the one before. `frame` is its number; time_limit_ms begins at `start`.
  void begin_frame(std::uint32_t frame, Clock::time_point start, RefineStats& stats);

  // Exchanges splits until no candidate matters more than what is applied, or the budget or a limit ends it.
  void run();
  // Goes on after run() with entries that have turned out to be visible.
  void run_on(std::span<const Entry> shown);
  // If the budget is enough, takes back leaves that nobody sees or that are well within the tolerance.
  void take_back_needless();

  // Returns the priority at which the budget ended.
  [[nodiscard]] float level() const noexcept { return level_; }
  // Returns false while candidates are left to later frames because refinement from scratch was recent.
  [[nodiscard]] bool has_settled() const noexcept { return settling_level_ == 0.0F; }
  // Returns the number of splits and merges in this frame.
  [[nodiscard]] std::size_t changes() const noexcept { return changes_; }
  // Returns the largest error of candidates that found no room.
  [[nodiscard]] const ScreenError& rejected_error() const noexcept { return rejected_; }

  // apply_split() calls these.
  [[nodiscard]] float forced_weight(const Entry& entry, const Cut::Closure& closure);
  bool step_back(const Entry& entry);
  bool make_room(float turn_priority, float priority);
  void apply_closure(const Entry& entry, const Cut::Closure& closure);

 private:
  void gather();
  void gather_candidates(float low, float high);
  void find_worths(std::uint32_t object);
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
  [[nodiscard]] std::size_t candidates_at_once() const;
  [[nodiscard]] bool is_looked_at(const Entry& entry) const;
  void look_ahead();
  void take_ahead();
  void descend_ahead(float least);
  void descend_all(std::uint32_t object, std::span<const Entry> visits, float least);
  [[nodiscard]] std::optional<Entry> visit_of(std::uint32_t object, Front::Index k) const;
  [[nodiscard]] std::optional<Entry> split_of(std::uint32_t object, Front::Index k, const SplitWorth& worth) const;
  void enqueue_visit(std::uint32_t object, Front::Index k);
  void enqueue_split(std::uint32_t object, Front::Index k);
  void note_forced(const Entry& entry, const Cut::Closure& closure);
  bool take_back_least();
  void take_back(std::uint32_t object, SplitId s);
  void enqueue_new_leaf(std::uint32_t object, SplitId s);
  void enqueue_leaf(std::uint32_t object, SplitId s, float priority);
  [[nodiscard]] float leaf_priority(const SplitWorth& worth) const;
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
  float settling_level_ = 0.0F;  // less important candidates are left to later frames while the budget is used up
  Queue candidates_;
  Queue leaves_;                                   // ordered by 1 / priority
  float candidates_above_ = 0.0F;                  // candidates with larger priorities are queued
  float last_step_ = 0.0F;                         // below it, all other candidates are queued at once
  float leaves_below_ = 0.0F;                      // leaves with smaller priorities are queued
  std::size_t changes_ = 0, changes_before_ = 0;   // in this frame and the one before
  std::size_t next_ahead_ = 0;                     // how many candidates are looked at next
  std::vector<Entry> ahead_, visits_, looked_at_;  // scratch of look_ahead()
  ScreenError rejected_;
  UnseenNeeds unseen_needs_;
  std::vector<Front::Index> found_;  // scratch, like the next two
  std::vector<SplitWorth> worths_;
  std::vector<SplitId> sorted_;
};

// Refines by going on from the frame before. One frame:
//   evaluates the front in the new view, where the last evaluation has expired or matters;
//   asks again about hidden nodes, and about a part of the applied splits;
//   exchanges splits, worst candidates first;
//   checks hidden nodes with large errors against the new mesh, where such checks have been of use lately.
// There are about twice as many nodes as applied splits, and they are scanned in vectors; what is evaluated and queued
// is in proportion to what changes.
class Frames {
 public:
  // Keeps the triangles of the objects in `result`, which must outlive this object.
  Frames(std::span<const RefineObject> objects, std::span<RefinedObject> result);
  Frames(const Frames&) = delete;
  Frames& operator=(const Frames&) = delete;

  // Takes over cuts from refinement from scratch. `level` is the priority at which the budget ended; `hidden` lists
  // what was hidden at the end. The scene must outlive the frame.
  void adopt(const RefinedScene& scene, float level, std::span<const Entry> hidden);

  // Evaluates the front in a new view. Returns false when a quarter of the cut has become worthless, so that it is
  // better to start from scratch. Changed options are no reason to.
  [[nodiscard]] bool move_to(const RefinedScene& scene);
  // Refines after move_to(). `moved`: the view, or what the backend would answer, differs from that of the frame
  // before.
  void advance(bool moved, Clock::time_point start, RefineStats& stats);
  void forget_hidden() { queries_.forget_hidden(); }

  // Updates the result of the frame before, after adopt() or advance().
  void emit(std::span<RefinedObject> out, RefineStats& stats);
  // Returns the ages of applied splits of one object: see Refiner::visibility_ages().
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::uint32_t object,
                                                           std::span<const SplitId> splits) const {
    return queries_.visibility_ages(object, splits);
  }
  // Returns whether the next frame will change nothing unless the view or the options change.
  [[nodiscard]] bool at_rest() const noexcept { return at_rest_; }

 private:
  void begin();
  void exchange_splits(bool moved, RefineStats& stats);
  void measure(RefineStats& stats);

  FrontEvaluation evaluation_;
  FrontForest forest_;
  FrontQueries queries_;
  std::vector<DrawnMesh> meshes_;
  SplitExchange exchange_;
  std::uint32_t frame_ = 0;
  std::uint32_t moved_frame_ = 0;  // last frame in which the view moved
  AppliedCount before_;            // counts at the end of the last frame
  std::uint32_t same_frames_ = 0;  // consecutive frames in one view that kept the mesh
  // Number of checks of hidden nodes against a frame's own mesh, from the last that showed something on.
  std::uint32_t checks_since_useful_ = 0;
  bool at_rest_ = false;
};

}  // namespace occlod
