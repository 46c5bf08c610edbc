// Refinement from the base meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "priority/queue.h"
#include "refine/apply_split.h"
#include "refine/entry_queries.h"
#include "refine/lookahead.h"
#include "refine/refined_scene.h"
#include "refine/victims.h"

namespace occlod {

// One refinement, from the base meshes to the end of the budget:
//   while there is something that may matter: take the worst; ask whether it is seen; descend below it, or apply it.
// (Birkholz & Rahn, sec. 3.2 and 3.3.) Deviations: nodes are asked about shortly before their turn comes rather than
// when they are found, so that little is spent on those whose turn never comes, except that children of a visible node
// go straight into a flight that has room; with Culling::star a node is descended and applied by separate questions,
// and a split waits for as long as what it forces is not worth it; and what is hidden at the end is asked about once
// more. Reuses its memory.
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
  bool make_room(float turn_priority, float priority);
  void apply_closure(const Entry& entry, const Cut::Closure& closure);

 private:
  void begin();
  void run();
  [[nodiscard]] bool used_up() const;
  [[nodiscard]] bool matters(const Entry& entry) const { return !level_ || entry.priority > *level_; }
  void take_next();
  void process_answer();
  void process(Entry& entry);
  void readmit();
  void finish();
  void count_forced();

  void enqueue_roots(std::uint32_t object);
  void enqueue_node(const Entry& parent, SplitId s, float scale_px);
  void enqueue_split(const Entry& node);
  void enqueue(const Entry& entry);
  void apply(Entry entry);
  bool leaves(const ScreenError& error);

  [[nodiscard]] Growth growth() const;
  [[nodiscard]] bool occluder_due();

  RefinedScene scene_;
  RefineStats* stats_ = nullptr;
  Queue queue_;
  EntryQueries entries_;
  Lookahead lookahead_;
  Victims victims_;
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
