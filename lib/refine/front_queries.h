// Grows and shrinks fronts along the forest, and asks about their nodes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "refine/front_evaluation.h"

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

  // Reaches the children of s and evaluates them; the result is valid until the next call. Throws Error when the forest
  // in the file is inconsistent.
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
  // Unmarks all hidden nodes, because no earlier answer holds any more.
  void forget_hidden();

  // Draws an occluder, then asks about hidden nodes that would matter and about a rotating share of the leaves. What is
  // met for the first time is asked about when its turn comes. `level` is the priority at which the budget ended.
  // Returns how many hidden nodes are shown now.
  std::size_t ask_again(float level);
  // Draws an occluder, then asks about hidden nodes that would matter. Returns those that are shown now; valid until
  // the next question.
  std::span<const Entry> check_hidden(float level);
  // Returns whether the occluder of this frame hides the entry. Asks unless it has been asked already.
  [[nodiscard]] bool is_hidden(const Entry& entry);
  // Asks about a split that has become a leaf, unless this view has shown it.
  void ask_about_new_leaf(std::uint32_t object, Front::Index k);

  // Returns the ages of applied splits of one object: see Refiner::visibility_ages().
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
  std::uint32_t draw_ = 0;          // occluders drawn so far
  std::uint32_t adopted_draw_ = 0;  // draw_ when the cut was taken over
  std::uint32_t fresh_draw_ = 0;    // answers with earlier occluders are out of date
  std::vector<Entry> asked_;        // scratch, like the next two
  std::vector<OcclusionQueries::Verdict> verdicts_;
  std::vector<Front::Index> found_;
};

}  // namespace occlod
