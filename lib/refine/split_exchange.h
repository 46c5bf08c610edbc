// Which splits of the frame before give way to which others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/milliseconds_since.h"
#include "refine/queue.h"
#include "refine/apply_split.h"
#include "refine/drawn_mesh.h"
#include "refine/front_evaluation.h"
#include "refine/front_forest.h"
#include "refine/front_queries.h"
#include "refine/unseen_needs.h"

namespace occlod {

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

}  // namespace occlod
