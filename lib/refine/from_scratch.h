// Applied splits that could be given up for something better.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "base/threads.h"
#include "refine/cut.h"
#include "refine/importance.h"
#include "refine/occluder.h"
#include "refine/queue.h"
#include "refine/refined_scene.h"
#include "refine/star_visibility.h"
#include "refine/tuning.h"

namespace occlod {

// Leaves of the cuts of all objects, the least important on top.
class Victims {
 public:
  void clear() noexcept;
  [[nodiscard]] bool gathered() const noexcept { return gathered_; }

  // Looks at every applied split. O(n).
  void gather(const CutSet& cuts, std::span<Importance> importances);

  struct Victim {
    std::uint32_t object = 0;
    SplitId split = no_id;
    float priority = 0.0F;  // as in Importance::Value; of splits that change nothing that is seen 0
    ScreenError error;
  };
  // Takes back the least important leaf, if that is worth less than `priority`.
  std::optional<Victim> take_back_below(float priority, CutSet& cuts, std::span<Importance> importances);

 private:
  void push(std::uint32_t object, SplitId s, Importance& importance);

  bool gathered_ = false;
  std::vector<Victim> heap_;
  std::vector<SplitId> leaves_;  // scratch, both of one object
  std::vector<Importance::Value> values_;
};

// What refinement from scratch may do next: nodes to look at, and splits to apply.

struct EntryQueues {
  Queue visits, applies;

  [[nodiscard]] bool empty() const noexcept { return visits.empty() && applies.empty(); }
  // Of what is most important, 0 where there is nothing.
  [[nodiscard]] float top_priority() const noexcept {
    return std::max(visits.empty() ? 0.0F : visits.top().priority, applies.empty() ? 0.0F : applies.top().priority);
  }
  void clear() noexcept {
    visits.clear();
    applies.clear();
  }
  void push(const Entry& entry) { (entry.kind == Entry::Kind::visit ? visits : applies).push(entry); }
  // Calls visit(const Entry&) for each.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    visits.for_each(visit);
    applies.for_each(visit);
  }
};

// Which entries of the queues of refinement from scratch are asked about, when, and which are hidden.

// An entry is asked about once for each occluder at most, when its turn comes. Reuses its memory.
class EntryQueries {
 public:
  void begin(const RefinedScene& scene);

  // How many occluders have been drawn.
  [[nodiscard]] std::uint32_t occluder() const noexcept { return occluder_; }
  // Entries that the occluder of their time hid.
  [[nodiscard]] std::span<const Entry> hidden() const noexcept { return hidden_; }
  // Some entries, and what is asked about them. Reuses its memory.
  struct Questions {
    std::vector<Entry> asked;
    std::vector<std::size_t> places;  // of these among all
    std::vector<OcclusionQueries::Verdict> verdicts;
    OcclusionQueries::Scratch scratch;
    double milliseconds = 0.0;  // that it took
  };
  // Asks about those that must be asked about. What is hidden is taken out; the others stay in their order. Then
  // note_answers() is to be called. On any thread, where many may ask; only the time of the caller's own counts.
  void take_out_hidden(std::vector<Entry>& entries, Questions& questions) const;
  void note_answers(const Questions& questions, bool own_time = true);

  // When it is time for an occluder.
  [[nodiscard]] OccluderSteps& steps() noexcept { return steps_; }
  // The cuts as they are. Where options say so, what older ones hid is put back into the queues.
  void draw_occluder(EntryQueues& queues, const Growth& now);
  // Asks about all that is hidden before an occluder drawn now; what it shows is put into the queues. Returns how many.
  std::size_t ask_again_about_hidden(EntryQueues& queues, const Growth& now);

 private:
  [[nodiscard]] bool must_ask(const Entry& entry) const {
    return entry.asked_occluder != occluder_ && queries_->asks(entry);
  }
  void hide(const Entry& entry);
  void forget_verdict(const Entry& entry) const;

  RefinedScene scene_;
  OcclusionQueries* queries_ = nullptr;
  OccluderSteps steps_;
  std::uint32_t occluder_ = 0;
  std::vector<Entry> hidden_;
  std::vector<Entry> doubtful_;  // scratch: what earlier occluders hid
  Questions about_doubtful_;
};

// What nodes of the forest have to offer when refinement comes to them: their own splits, and their children.

// Many nodes at once, in pieces that one or two threads work on. Whether nodes are seen and what they have to offer
// depends on hierarchies, views and the occluder alone, on nothing that refinement does meanwhile. Reuses its memory.
class NodeVisits {
 public:
  struct Child {
    SplitId split = no_id;  // no_id: there is none
    float scale_px = 0.0F;  // what weigh_splits() tells
    ScreenError error;
  };
  struct Found {
    Importance::Value value;  // of the split itself, with Culling::star
    std::array<Child, 2> children;
  };
  struct Piece {
    std::vector<Entry> visits;  // that are not hidden
    std::vector<Found> found;   // of each of them
    EntryQueries::Questions questions;
    bool by_caller = false;  // and not by the other thread
  };

  // All of them outlive the work. `visits`: those of one object should be side by side.
  void begin(const RefinedScene& scene, const EntryQueries& entries, std::span<const Entry> visits);
  [[nodiscard]] std::size_t piece_count() const noexcept { return piece_count_; }
  // Works on pieces until all are done or under way. Throws Error when a node is damaged or is not where its parent
  // says.
  void work_as_caller() { work(0); }
  void work_beside() { work(1); }
  // No other piece is begun.
  void end() noexcept { next_ = piece_count_; }
  // When all are done.
  [[nodiscard]] std::span<const Piece> pieces() const noexcept { return std::span(pieces_).first(piece_count_); }

 private:
  // Of a thread.
  struct Scratch {
    StarVisibility star_visibility;
    std::vector<SplitId> splits, children;  // of one object; children of an entry at twice its place
    std::vector<StarView> stars;
    std::vector<float> scales_px;
  };
  void work(std::size_t thread);
  void evaluate(Piece& piece, Scratch& scratch) const;
  void evaluate_object(std::span<const Entry> visits, std::span<Found> found, Scratch& scratch) const;

  RefinedScene scene_;
  const EntryQueries* entries_ = nullptr;
  std::vector<Piece> pieces_;
  std::size_t piece_count_ = 0;
  std::atomic<std::size_t> next_ = 0;
  std::array<Scratch, 2> scratch_;
};

// Refinement from the base meshes.

// One refinement, from the base meshes to the end of the budget:
//   while there is something that may matter: take the worst; ask whether it is seen; descend below it, or apply it.
// (Birkholz & Rahn, sec. 3.2 and 3.3.) Deviations: nodes that are about as bad are looked at together, so that memory
// and vectors work for many at once, and splits are applied, worst first, when all nodes that are worse have been.
// Nodes are asked about when their turn comes rather than when they are found, so that nothing is spent on those whose
// turn never comes. With Culling::star a node is descended and applied by separate questions, and a split waits for as
// long as what it forces is not worth it; and what is hidden at the end is asked about once more. Reuses its memory.
class FromScratch {
 public:
  // The cuts are what is left; all arguments outlive the call. Adds to `stats`.
  void refine(const RefinedScene& scene, RefineStats& stats);

  // The priority where the budget ended, before the final check.
  [[nodiscard]] float end_level() const noexcept { return end_level_; }
  // What was hidden at the end.
  [[nodiscard]] std::span<const Entry> hidden() const noexcept { return entries_.hidden(); }

  // For apply_split().
  [[nodiscard]] float forced_weight(const Entry& entry, const Cut::Closure& closure) const;
  bool step_back(const Entry& entry);
  bool make_room(float turn_priority, float priority);
  void apply_closure(const Entry& entry, const Cut::Closure& closure);

 private:
  void begin();
  void run();
  [[nodiscard]] bool used_up() const;
  [[nodiscard]] bool matters(const Entry& entry) const { return !level_ || entry.priority > *level_; }
  void take_visits();
  void start_visits();
  void finish_visits();
  void enqueue_found();
  void apply_visited(std::span<const Entry> visits);
  bool apply_above_visits();
  [[nodiscard]] bool is_above_visits(const Entry& entry) const {
    return taken_visits_.empty() || Queue::band_of(entry) > visits_band_;
  }
  [[nodiscard]] bool take_applies();
  void apply_taken();
  void look_at_needed();
  void draw_occluder();
  void readmit();
  void finish();
  void count_forced();

  void enqueue_roots(std::uint32_t object);
  struct Place {
    std::uint32_t object;
    std::uint32_t level;  // in the forest
  };
  void enqueue_node(const Place& at, const NodeVisits::Child& node);
  void enqueue_split(const Entry& node, const Importance::Value& value);
  void apply(Entry entry);
  bool leaves(const ScreenError& error);

  [[nodiscard]] Growth growth() const;
  [[nodiscard]] bool step_due();
  [[nodiscard]] bool occluder_due();

  RefinedScene scene_;
  RefineStats* stats_ = nullptr;
  EntryQueues queues_;
  EntryQueries entries_;
  Victims victims_;
  unsigned threads_ = 1;
  bool waits_for_memory_ = false;  // the budget is too large for caches

  // The nodes that are looked at, by objects, and what they have to offer.
  std::vector<Entry> taken_visits_;
  std::size_t visits_band_ = 0;
  bool visits_known_ = true;
  NodeVisits visits_;
  struct WorkBeside {
    NodeVisits& visits;
    void operator()() const { visits.work_beside(); }
  } work_beside_{visits_};
  CompanionThread companion_;

  // The next splits, in order, and the one of them whose turn it is.
  std::vector<Entry> applies_;
  std::size_t turn_ = 0;
  EntryQueries::Questions about_applies_;
  std::vector<SplitId> needed_;        // scratch
  std::vector<float> root_scales_px_;  // of one object

  struct Forced {
    std::uint32_t object;
    SplitId split;
    bool unseen;
  };
  std::vector<Forced> forced_;  // in the order of application
  // Of splits that have been taken back (object << 32 | split): how many had been forced until then.
  std::unordered_map<std::uint64_t, std::size_t> taken_back_;
  std::size_t rejections_in_a_row_ = 0;
  std::optional<float> level_;  // of priorities, where the budget ended: set when what was hidden is checked
  float end_level_ = 0.0F;
  ScreenError left_;  // the largest of what is held to be visible and is not refined
};

}  // namespace occlod
