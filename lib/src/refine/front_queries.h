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
  // been spent on, or all of that. What is met for the first time is asked about when its turn comes. `level`: the
  // priority where the budget ended. Returns how many hidden things are shown now.
  std::size_t ask_again(float level, bool all);
  // As ask_again(), after the mesh has changed so much in this frame that its first occluder was another mesh.
  std::size_t ask_all_anew(float level);
  // Whether the occluder of this frame hides it: asked now, unless it has been.
  [[nodiscard]] bool is_hidden(const Entry& entry);

  // Of applied splits of one object: see Refiner::visibility_ages().
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::uint32_t object, std::span<const SplitId> splits) const;

 private:
  void forget_what_is_not_asked(std::uint32_t object);
  void ask_about(std::uint32_t object, Front::Index k, Entry::Kind kind);
  void ask_about_hidden(std::uint32_t object, float least);
  void ask_about_unapplied(std::uint32_t object, float least);
  void ask_about_leaves(std::uint32_t object, bool all);
  [[nodiscard]] bool is_shown_since(std::uint32_t draw, const FrontNode& node, Entry::Kind kind) const;
  void note(const Entry& entry, bool visible);

  FrontEvaluation& evaluation_;
  std::uint32_t frame_ = 0;
  std::uint32_t draw_ = 0;          // occluders so far
  std::uint32_t adopted_draw_ = 0;  // the last of them before the cut was taken over
  std::uint32_t fresh_draw_ = 0;    // verdicts before earlier ones are out of date
  std::size_t shown_again_ = 0;     // by what is being asked
  std::vector<Entry> asked_;        // scratch, all of them
  std::vector<OcclusionQueries::Verdict> verdicts_;
  std::vector<Front::Index> found_;
};

}  // namespace occlod
