// Refinement from the base meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "priority/queue.h"
#include "priority/star_visibility.h"
#include "queries/occluder.h"
#include "queries/occluder_steps.h"
#include "queries/questions.h"
#include "refine/lookahead.h"
#include "refine/refined_cuts.h"
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
  void refine(const RefinedCuts& refined, const RefineOptions& options, Questions& questions, Occluder& occluder,
              RefineStats& stats);

  // The priority where the budget ended, before the final check.
  [[nodiscard]] float end_level() const noexcept { return end_level_; }
  // What was hidden at the end.
  [[nodiscard]] std::span<const Entry> hidden() const noexcept { return hidden_; }

 private:
  void begin();
  void run();
  [[nodiscard]] bool used_up() const;
  [[nodiscard]] bool matters(const Entry& entry) const { return !level_ || entry.priority > *level_; }
  void readmit();
  void finish();

  void meet_roots(std::uint32_t object);
  void meet(std::uint32_t object, SplitId s, float scale_px, SplitId parent, std::uint32_t level);
  bool is_tolerated(const ScreenError& error);
  void process(Entry& entry);
  void consider(const Entry& entry);
  void apply(const Entry& entry);
  bool waits(const Entry& entry, const Cut::Closure& closure);
  bool make_room(const Entry& entry);
  void count_splits(const Entry& entry, const Cut::Closure& closure);

  // Into the flight if it has room for a question that must be asked, else into the global queue.
  void offer(const Entry& entry) {
    if (questions_->in_flights() && questions_->has_room() && matters(entry) && must_ask(entry))
      ask(entry);
    else
      queue_.push(entry);
  }
  [[nodiscard]] bool must_ask(const Entry& entry) const;
  void ask(const Entry& entry);
  void fill_flight();
  void take_next();
  void ask_ahead();
  template <typename Answered>
  void ask_all(const Answered& answered);
  void ask_about_doubtful();
  void note_answer(const Entry& entry, bool visible);
  void hide(const Entry& entry);
  void settle();
  void settle_later();
  void drain();
  Entry take_answer();
  [[nodiscard]] Growth growth() const { return {stats_->splits, triangles_ - base_triangles_}; }
  [[nodiscard]] bool occluder_due() const;
  void draw_occluder();
  void doubt(const Entry& entry) const;

  RefinedCuts refined_;
  const RefineOptions* options_ = nullptr;
  Questions* questions_ = nullptr;
  Occluder* occluder_mesh_ = nullptr;
  RefineStats* stats_ = nullptr;
  OccluderSteps steps_;
  Queue queue_;
  Lookahead lookahead_;
  std::vector<float> root_scales_px_;  // of one object
  std::vector<Entry> hidden_;          // found hidden by the occluder of their time
  std::vector<Entry> doubtful_;  // found hidden by earlier occluders than that before which they are now asked about
  std::vector<Entry> asked_;     // scratch: about which many questions are asked at once,
  std::vector<Entry*> asked_entries_;  // and where they are in the queue
  StarVisibility star_;
  Victims victims_;
  std::size_t base_triangles_ = 0;
  std::size_t triangles_ = 0;   // of all cuts
  std::uint32_t occluder_ = 0;  // how many have been drawn
  std::size_t rejections_in_a_row_ = 0;
  std::optional<float> level_;  // of priorities, where the budget ended: set when what was hidden is checked
  float end_level_ = 0.0F;
  ScreenError left_;  // the largest of what is held to be visible and is not refined
};

}  // namespace occlod
