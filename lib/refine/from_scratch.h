// Refines from the base meshes to the end of the budget.
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

// Holds leaves of the cuts of all objects that could be given up for something better, the least important on top.
class Victims {
 public:
  void clear() noexcept;
  [[nodiscard]] bool gathered() const noexcept { return gathered_; }

  // Collects the leaves from all applied splits. O(n).
  void gather(const CutSet& cuts, std::span<Importance> importances);

  struct Victim {
    std::uint32_t object = 0;
    SplitId split = no_id;
    float priority = 0.0F;  // as in Importance::Value; 0 if the split changes nothing that is seen
    ScreenError error;
  };
  // Takes back the least important leaf, if its priority is below `priority`, and returns it.
  std::optional<Victim> take_back_below(float priority, CutSet& cuts, std::span<Importance> importances);

 private:
  void push(std::uint32_t object, SplitId s, Importance& importance);

  bool gathered_ = false;
  std::vector<Victim> heap_;
  std::vector<SplitId> leaves_;  // scratch for one object, like the next one
  std::vector<Importance::Value> values_;
};

// Holds splits that have been weighed down by what they would force. When something that one needs directly is applied
// by another, it is given back, to be weighed again: otherwise it would stay weighed down by what is no longer forced.
// Reuses its memory.
class WaitingSplits {
 public:
  void clear() noexcept;
  // Lets an unweighed entry wait for splits of its object.
  void wait(const Entry& entry, std::span<const SplitId> needed);
  // Appends the entries that wait for one of these splits and lets them wait no longer. O(splits + entries).
  void wake(std::uint32_t object, std::span<const SplitId> applied, std::vector<Entry>& woken);

 private:
  static constexpr std::uint32_t none = no_id;
  // A slot of a table with open addressing, at most half full.
  struct Slot {
    SplitId needed = no_id;  // no_id: the slot is free
    std::uint32_t object = 0;
    std::uint32_t first = none;  // first link of those who wait for this split
  };
  struct Link {
    std::uint32_t entry;
    std::uint32_t next;
  };
  [[nodiscard]] Slot& slot_of(std::uint32_t object, SplitId needed);
  void grow();

  std::vector<Entry> entries_;
  std::vector<bool> waits_;  // per entry
  std::vector<Link> links_;
  std::vector<Slot> slots_;
  std::size_t used_slots_ = 0;
};

// Holds what refinement from scratch may do next: nodes to visit and splits to apply.
struct EntryQueues {
  Queue visits, applies;

  [[nodiscard]] bool empty() const noexcept { return visits.empty() && applies.empty(); }
  // Returns the largest priority, 0 when there is no entry.
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

// Asks about entries of the queues of refinement from scratch and keeps the hidden ones. An entry is asked about once
// for each occluder at most, when its turn comes. Reuses its memory.
class EntryQueries {
 public:
  void begin(const RefinedScene& scene);

  // Returns how many occluders have been drawn.
  [[nodiscard]] std::uint32_t occluder() const noexcept { return occluder_; }
  // Returns the entries that were hidden when they were asked about.
  [[nodiscard]] std::span<const Entry> hidden() const noexcept { return hidden_; }
  // Holds some entries and the answers about them. Reuses its memory.
  struct Questions {
    std::vector<Entry> asked;
    std::vector<std::size_t> places;  // their indices among all entries
    std::vector<Entry> newly_covered;
    std::vector<OcclusionQueries::Verdict> verdicts;
    OcclusionQueries::Scratch scratch;
    double milliseconds = 0.0;  // time that asking took
  };
  // Asks about entries that must be asked about and removes the hidden ones; the others keep their order. Those whose
  // vertices turn out to be covered go to `newly_covered` with lower priorities. note_answers() must follow. May run on
  // any thread if the backend allows that; only the caller's own time counts.
  void take_out_hidden(std::vector<Entry>& entries, Questions& questions) const;
  void note_answers(const Questions& questions, bool own_time = true);

  // Returns the steps at which occluders are drawn.
  [[nodiscard]] OccluderSteps& steps() noexcept { return steps_; }
  // Draws the current cuts. With Tuning::retest_hidden, puts what older occluders hid back into the queues.
  void draw_occluder(EntryQueues& queues, const Growth& now);
  // Draws an occluder, asks about all hidden entries and queues those that it shows. Returns their number.
  std::size_t ask_again_about_hidden(EntryQueues& queues, const Growth& now);

 private:
  [[nodiscard]] bool must_ask(const Entry& entry) const {
    return entry.asked_occluder != occluder_ && queries_->asks(entry);
  }
  void hide(const Entry& entry);
  void forget_verdict(const Entry& entry) const;
  void set_covered(Entry& entry, bool covered) const;

  RefinedScene scene_;
  OcclusionQueries* queries_ = nullptr;
  OccluderSteps steps_;
  std::uint32_t occluder_ = 0;
  std::vector<Entry> hidden_;
  std::vector<Entry> doubtful_;  // scratch: entries that earlier occluders hid
  Questions about_doubtful_;
};

// Visits many nodes at once, in pieces that any number of threads work on, and finds their own splits and their
// children. The result depends on hierarchies, views and the occluder alone, not on what refinement does meanwhile.
// Reuses its memory.
class NodeVisits {
 public:
  struct Child {
    SplitId split = no_id;  // no_id: no child
    float scale_px = 0.0F;  // result of weigh_splits()
    ScreenError error;
  };
  struct Found {
    Importance::Value value;  // value of the node's own split, with Culling::star
    std::array<Child, 2> children;
  };
  struct Piece {
    std::vector<Entry> visits;  // nodes that are not hidden
    std::vector<Found> found;   // one for each visit
    EntryQueries::Questions questions;
    bool by_caller = false;  // whether the calling thread worked on it
  };

  // Starts new visits by up to `threads` threads. All arguments must outlive the work. Entries of one object should be
  // adjacent in `visits`.
  void begin(const RefinedScene& scene, const EntryQueries& entries, std::span<const Entry> visits, unsigned threads);
  [[nodiscard]] std::size_t piece_count() const noexcept { return piece_count_; }
  // Works on pieces until all are done or under way. The calling thread is 0, the others have numbers below `threads`.
  // Throws Error when a node is damaged or is not where its parent says.
  void work(unsigned thread);
  // Lets no further piece begin.
  void end() noexcept { next_ = piece_count_; }
  // Returns all pieces, when they are done.
  [[nodiscard]] std::span<const Piece> pieces() const noexcept { return std::span(pieces_).first(piece_count_); }

 private:
  // Holds the scratch memory of one thread.
  struct Scratch {
    StarVisibility star_visibility;
    std::vector<SplitId> splits, children;  // of one object; children of splits[i] from 2 * i on
    std::vector<StarView> stars;
    std::vector<float> scales_px;
  };
  void evaluate(Piece& piece, Scratch& scratch) const;
  void evaluate_object(std::span<const Entry> visits, std::span<Found> found, Scratch& scratch) const;

  RefinedScene scene_;
  const EntryQueries* entries_ = nullptr;
  std::vector<Piece> pieces_;
  std::size_t piece_count_ = 0;
  std::atomic<std::size_t> next_ = 0;
  std::vector<Scratch> scratch_;  // by thread
};

// Refines once, from the base meshes to the end of the budget:
//   while something may matter: take the worst; ask whether it is seen; descend below it, or apply it.
// This is Birkholz & Rahn, sec. 3.2 and 3.3, with deviations. Nodes that are about equally bad are visited together, so
// that memory and vectors serve many at once, and splits are applied, worst first, after all worse nodes have been
// visited. Nodes are asked about when their turn comes, not when they are found, so that nothing is spent on those
// whose turn never comes. With Culling::star, separate questions decide about descending and applying, and a split
// waits as long as what it forces is not worth it, or until others have needed that as well. What is hidden at the end
// is asked about once more. Reuses its memory.
class FromScratch {
 public:
  // Leaves the result in the scene's cuts and adds to `stats`. All arguments must outlive the call.
  void refine(const RefinedScene& scene, RefineStats& stats);

  // Returns the priority at which the budget ended, before the final check.
  [[nodiscard]] float end_level() const noexcept { return end_level_; }
  // Returns what was hidden at the end.
  [[nodiscard]] std::span<const Entry> hidden() const noexcept { return entries_.hidden(); }

  // apply_split() calls these.
  [[nodiscard]] float forced_weight(const Entry& entry, const Cut::Closure& closure);
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
  [[nodiscard]] bool is_done(const Entry& entry) const;
  void apply_taken();
  void take_woken();
  void look_at_needed();
  void draw_occluder();
  void readmit();
  void finish();
  void count_forced();

  void enqueue_roots(std::uint32_t object);
  struct Place {
    std::uint32_t object;
    std::uint32_t level;  // level in the forest
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
  bool waits_for_memory_ = false;  // whether the budget is too large for the caches

  // The nodes being visited, sorted by object, and what is found there.
  std::vector<Entry> taken_visits_;
  std::size_t visits_band_ = 0;
  bool visits_known_ = true;
  NodeVisits visits_;
  struct WorkBeside {
    NodeVisits& visits;
    void operator()(unsigned thread) const { visits.work(thread); }
  } work_beside_{visits_};
  SharedWork beside_;

  // The next splits, in order, and the index of the one whose turn it is.
  std::vector<Entry> applies_;
  std::size_t turn_ = 0;
  EntryQueries::Questions about_applies_, about_woken_;
  WaitingSplits waiting_;
  std::vector<Entry> woken_;  // scratch, like the next one
  std::vector<SplitId> needed_;
  std::vector<float> root_scales_px_;  // scratch for one object

  struct Forced {
    std::uint32_t object;
    SplitId split;
    bool unseen;
  };
  std::vector<Forced> forced_;  // in the order of application
  // By object << 32 | split, for splits that have been taken back: the size of forced_ at that time.
  std::unordered_map<std::uint64_t, std::size_t> taken_back_;
  std::size_t rejections_in_a_row_ = 0;
  std::optional<float> level_;  // priority at which the budget ended; set in the final check
  float end_level_ = 0.0F;
  ScreenError left_;  // largest error of what is held to be visible and is not refined
};

}  // namespace occlod
