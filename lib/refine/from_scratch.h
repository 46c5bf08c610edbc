// Refinement from the base meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "base/companion_thread.h"
#include "refine/apply_split.h"
#include "refine/entry_queries.h"
#include "refine/entry_queues.h"
#include "refine/node_visits.h"
#include "refine/refined_scene.h"
#include "refine/victims.h"

namespace occlod {

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
