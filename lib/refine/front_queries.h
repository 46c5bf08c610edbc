// What a frame asks about occlusion, and what is known of it from frames before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "refine/front_evaluation.h"

namespace occlod {

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
  [[nodiscard]] float least_error(float level) const;

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
