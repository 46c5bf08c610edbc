// How fronts grow and shrink along the forest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "refine/front_evaluation.h"

namespace occlod {

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

}  // namespace occlod
