// Refinement that goes on from the frame before.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/milliseconds_since.h"
#include "occlod/refine/refiner.h"
#include "refine/drawn_mesh.h"
#include "refine/front_evaluation.h"
#include "refine/front_forest.h"
#include "refine/front_queries.h"
#include "refine/refined_scene.h"
#include "refine/split_exchange.h"

namespace occlod {

// One frame:
//   evaluate the front in the new view, as far as what is known of it has expired or matters;
//   ask again about what is hidden, and about a part of what is applied;
//   exchange splits, worst candidates first;
//   check what is hidden against the mesh that has come about, where such checks have been of use lately.
// The nodes are about twice as many as applied splits and are looked through in vectors; what is evaluated and queued
// is in proportion to what changes.
class Frames {
 public:
  // Keeps the triangles of the objects in `result`, which outlives it.
  Frames(std::span<const RefineObject> objects, std::span<RefinedObject> result);
  Frames(const Frames&) = delete;
  Frames& operator=(const Frames&) = delete;

  // Takes over cuts that refinement from scratch has made: `level` is the priority where the budget ended, `hidden`
  // what was hidden at the end. The scene outlives the frame.
  void adopt(const RefinedScene& scene, float level, std::span<const Entry> hidden);

  // Evaluates the front in a new view. False when a quarter of the cut has become worth little: then it is better to
  // start from scratch. Options that differ from those of the frame before are no reason to.
  [[nodiscard]] bool move_to(const RefinedScene& scene);
  // After move_to(). `moved`: the view, or what the backend would answer, differs from that of the frame before.
  void advance(bool moved, Clock::time_point start, RefineStats& stats);
  void forget_hidden() { queries_.forget_hidden(); }

  // After adopt() or advance(), into what the frame before got.
  void emit(std::span<RefinedObject> out, RefineStats& stats);
  // Of applied splits of one object: see Refiner::visibility_ages().
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::uint32_t object,
                                                           std::span<const SplitId> splits) const {
    return queries_.visibility_ages(object, splits);
  }
  // The next frame will change nothing unless the view or the options do.
  [[nodiscard]] bool at_rest() const noexcept { return at_rest_; }

 private:
  void begin();
  void exchange_splits(bool moved, RefineStats& stats);
  void note_check(std::span<const Entry> shown);
  void measure(RefineStats& stats);

  FrontEvaluation evaluation_;
  FrontForest forest_;
  FrontQueries queries_;
  std::vector<DrawnMesh> meshes_;
  SplitExchange exchange_;
  std::uint32_t frame_ = 0;
  std::uint32_t moved_frame_ = 0;  // in which the view moved last
  AppliedCount before_;            // when the last frame ended
  std::uint32_t same_frames_ = 0;  // in a row that have ended with the mesh that they began with, in one view
  // Of what is hidden, by the mesh of the frame itself: how many, from the last that found something that matters on.
  std::uint32_t checks_since_useful_ = 0;
  bool at_rest_ = false;
};

}  // namespace occlod
