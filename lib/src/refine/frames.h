// Refinement that goes on from the frame before.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/milliseconds_since.h"
#include "cut/face_list.h"
#include "occlod/refine/refiner.h"
#include "priority/bounded_values.h"
#include "priority/front.h"
#include "priority/queue.h"
#include "priority/star_visibility.h"
#include "priority/view_motion.h"
#include "priority/weigh_nodes.h"
#include "queries/occluder.h"
#include "queries/questions.h"
#include "refine/refined_cuts.h"

namespace occlod {

// One frame: nodes of what refinement has reached are weighed for the new view as far as what is known of them no
// longer holds, or as far as it matters; then, worst first, candidates are descended or applied, and take the place of
// applied leaves that matter less (the dual queues of Duchaineau et al., ROAMing Terrain, 1997, here over the
// dependencies of splits). The nodes are about twice as many as applied splits and are looked through in vectors; what
// is weighed and queued is in proportion to what changes. The priority where the budget ended is kept: only what is
// near that is queued.
class Frames {
 public:
  // Keeps the triangles of the objects in `result`, which outlives it.
  Frames(std::span<const RefineObject> objects, std::span<RefinedObject> result);

  // Takes over cuts that refinement from scratch has made: `level` is the priority where the budget ended, `hidden`
  // what was hidden at the end. All outlive the frame.
  void adopt(const RefinedCuts& refined, const RefineOptions& options, float level, std::span<const Entry> hidden);

  // Weighs all for a new view. False when a quarter of the cut has become worth little: then it is better to start from
  // scratch. Options that differ from those of the frame before are no reason to.
  [[nodiscard]] bool weigh(const RefinedCuts& refined, const RefineOptions& options);
  // After weigh(). `moved`: the view, or what the backend would answer, differs from that of the frame before.
  void advance(Questions& questions, Occluder& occluder, bool moved, Clock::time_point start, RefineStats& stats);
  void forget_hidden();

  // After adopt() or advance(), with what the frame before got.
  void emit(std::uint32_t i, RefinedObject& out, RefineStats& stats);
  // Of applied splits of one object: see Refiner::visibility_ages().
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::uint32_t object, std::span<const SplitId> splits) const;
  // The next frame will change nothing unless the view or the options do.
  [[nodiscard]] bool at_rest() const noexcept { return at_rest_; }

 private:
  struct Object {
    Object(const Hierarchy& hierarchy, std::vector<Triangle>& triangles)
        : front(hierarchy), faces(hierarchy, triangles) {}

    Front front;
    std::optional<ObjectView> view;  // of the last frame
    ViewMotion motion;               // since the front was last weighed as a whole
    FaceList faces;
    std::vector<SplitId> born, died;                        // in this frame
    std::vector<std::pair<SplitId, std::uint32_t>> morphs;  // splits with the frames in which they were applied
  };

  // What one split is worth in this view.
  struct Worth {
    float key = 0.0F;  // its priority; 0 = changes nothing that is seen
    float raw = 0.0F;  // without what it forces
    ScreenError error;
  };

  // Candidates and leaves are queued when their keys are within this factor of the level of the frame before; all are
  // when those do not suffice.
  static constexpr float band = 1.06F;
  static constexpr float band_step = 1.25F;  // where they do not suffice, down to `closing`
  // Nodes are no longer descended when they matter less than this part of the level.
  static constexpr float closing = 0.5F;
  // Of what is held to be visible, one in so many is asked about again in each frame.
  static constexpr std::uint32_t asking_rounds = 2;
  // A split's priority is at most its subtree's error times this: Importance counts no face as seen more edge-on than
  // under a cosine of 0.2.
  static constexpr float most_grazing = 2.3F;

  struct Applied {
    std::size_t all = 0;        // splits
    std::size_t worthless = 0;  // of those, that matter much less than what the budget goes to
  };
  [[nodiscard]] Applied count_applied() const;

  void begin(const RefinedCuts& refined, const RefineOptions& options);
  void adopt_splits(std::uint32_t object);
  void adopt_forest(std::uint32_t object);
  Front::Index reach(std::uint32_t object, SplitId s, SplitId parent, std::uint16_t level);
  template <typename Visit>
  void descend_from(std::uint32_t object, SplitId s, const Visit& visit_child);

  // What is known of all nodes of an object.
  [[nodiscard]] BoundedProducts errors(std::uint32_t object) const;
  [[nodiscard]] BoundedProducts guaranteed_errors(std::uint32_t object) const;
  [[nodiscard]] BoundedProducts priorities(std::uint32_t object) const;
  [[nodiscard]] BoundedProducts leaf_priorities(std::uint32_t object) const;

  void motion(std::uint32_t object);
  [[nodiscard]] glm::vec3 middle_of(std::uint32_t object) const;
  void renew(std::uint32_t object, std::span<const Front::Index> nodes);
  void renew_outdated(std::uint32_t object);
  [[nodiscard]] Worth worth(std::uint32_t object, Front::Index k);
  [[nodiscard]] Worth worth_by_star(std::uint32_t object, Front::Index k);
  [[nodiscard]] bool is_tolerated(const ScreenError& error) const;

  void close(std::uint32_t object);
  [[nodiscard]] bool is_closable(std::uint32_t object, Front::Index k) const;
  bool close_one(std::uint32_t object, SplitId s);
  void gather();
  void gather_candidates(float low, float high);
  void gather_leaves(float low, float high);
  void gather_more_candidates();
  bool gather_more_leaves();
  [[nodiscard]] float leaf_key(std::uint32_t object, Front::Index k);
  void push_leaf(std::uint32_t object, SplitId s, float key);
  void measure_errors();
  void measure_unreached(std::uint32_t object, const BoundedProducts& of, float so_far);
  void measure_unapplied(std::uint32_t object, const BoundedProducts& of, float so_far);

  void ask_again(Occluder& occluder, bool all);
  [[nodiscard]] bool is_shown_since(std::uint32_t draw, const FrontNode& node, Entry::Kind kind) const;
  [[nodiscard]] Entry::Kind leaf_question() const;
  void ask_about(std::uint32_t object, Front::Index k, Entry::Kind kind);
  void ask_about_hidden(std::uint32_t object);
  void ask_about_unapplied(std::uint32_t object);
  void ask_about_leaves(std::uint32_t object, bool all);
  void forget_what_is_not_asked(std::uint32_t object);
  [[nodiscard]] float least_that_matters() const;
  [[nodiscard]] bool asks_stars() const;
  void note(const Entry& entry, bool visible);
  [[nodiscard]] bool is_hidden(const Entry& entry);

  [[nodiscard]] bool has_changed_much() const;
  void let_new_ones_go();
  void run();
  [[nodiscard]] bool limit_reached() const;
  void descend(const Entry& entry);
  void offer(std::uint32_t i, Front::Index k);
  bool apply(Entry& entry);
  bool waits(Entry& entry, const Cut::Closure& closure);
  void apply_closure(std::uint32_t i, const Cut::Closure& closure);
  bool make_room(float key);
  [[nodiscard]] bool is_old_leaf(const Entry& leaf);
  bool take_back_least();
  void take_back_needless();
  void take_back(std::uint32_t i, SplitId s);
  void queue_new_leaf(std::uint32_t i, SplitId s);
  void emit_splits(Object& object, const Cut& cut, RefinedObject& out, RefineStats& stats);
  void emit_geomorphs(Object& object, const Cut& cut, std::vector<Geomorph>& out) const;

  RefinedCuts refined_;
  const RefineOptions* options_ = nullptr;
  Questions* questions_ = nullptr;
  RefineStats* stats_ = nullptr;
  Clock::time_point start_;
  std::vector<Object> objects_;
  std::optional<View> last_view_;
  bool adopted_ = false;  // in this frame
  bool at_rest_ = false;
  bool asks_leaves_ = false;  // when they become leaves
  std::uint32_t frame_ = 0;
  std::uint32_t moved_frame_ = 0;   // in which the view moved last
  std::uint32_t draw_ = 0;          // occluders so far
  std::uint32_t adopted_draw_ = 0;  // the last of them before the cut was taken over
  std::uint32_t fresh_draw_ = 0;    // verdicts before earlier ones are out of date
  float level_ = 0.0F;              // the priority where the budget ended
  float candidates_above_ = 0.0F;   // queued are candidates with larger keys
  float last_step_ = 0.0F;          // below which all the others are queued
  float leaves_below_ = 0.0F;       // and leaves with smaller ones
  Queue candidates_;
  Queue leaves_;  // by 1 / key
  std::size_t triangles_ = 0;
  std::size_t changes_ = 0;  // splits and merges in this frame
  Applied before_;           // when the last frame ended
  ScreenError left_;
  StarVisibility star_;
  std::vector<Entry> asked_;  // scratch, all of them
  std::vector<SplitId> sorted_;
  std::vector<SplitId> open_;
  std::vector<Front::Index> found_, renewed_, reached_;
};

// Calls visit_child(SplitId) for each child that is now reached. Throws Error for a file that lies about its forest.
template <typename Visit>
void Frames::descend_from(std::uint32_t object, SplitId s, const Visit& visit_child) {
  Front& front = objects_[object].front;
  const Front::Index k = front.find(s);
  front.set(k, Front::descended, true);
  const SplitNode& split = refined_.cuts[object].hierarchy().node(s);
  for (const SplitId child : {split.child_u, split.child_v}) {
    if (child == no_id) continue;
    reach(object, child, s, FrontNode::below(front.node(k).level));
    visit_child(child);
  }
}

}  // namespace occlod
