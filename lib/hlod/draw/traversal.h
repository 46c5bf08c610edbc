// The loop that strategies share: one queue of nodes by distance, one of questions in the order in which they were
// asked (Bittner and others 2004; Charalambos 2006, sec. 2.2.1; Charalambos and others 2007, fig. 2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hlod/draw/frame_scene.h"
#include "hlod/draw/policy.h"
#include "occlod/build_hlod.h"
#include "occlod/traverser.h"

namespace occlod::hlod {

// Makes draws on a device and records them in the frame.
class DrawRecorder {
 public:
  // The references must outlive the recorder.
  DrawRecorder(const FrameScene& scene, RenderDevice& device, CutCache& cuts, Frame& frame)
      : scene_(scene), device_(device), cuts_(cuts), frame_(frame) {}

  // Draws the patches of node n for which is_drawn(parent) is true, if any. `first` tells that no patch of it was drawn
  // in this frame.
  template <typename IsDrawn>
  void draw(NodeRef n, bool first, const IsDrawn& is_drawn) {
    first_range_ = frame_.ranges.size();
    std::uint32_t place = 0;
    for (const Patch& patch : scene_.hlod(n).patches(n.node)) {
      if (is_drawn(patch.parent)) add(n, patch, place);
      ++place;
    }
    if (frame_.ranges.size() > first_range_) submit(n, first);
  }

  // Draws the node refined within to an error of at most `max_error`, in object units. Returns false, and draws
  // nothing, when that would not change the node.
  bool draw_cut(NodeRef n, bool first, double max_error);
  // Draws the node over an earlier draw of it with `drawn_error`, if the new draw is finer.
  bool draw_finer_cut(NodeRef n, double max_error, double drawn_error);

 private:
  void submit_cut(NodeRef n, bool first, const NodeCut& cut);
  void add(NodeRef n, const Patch& patch, std::uint32_t place);
  void submit(NodeRef n, bool first);
  [[nodiscard]] float morph(NodeRef n, NodeId parent) const;

  const FrameScene& scene_;
  RenderDevice& device_;
  CutCache& cuts_;
  Frame& frame_;
  std::size_t first_range_ = 0;  // first range of the draw that is being made
};

// Tells whether a node may be refined.
enum class Permission {
  granted,  // every parent is refined or culled
  pending,  // a parent is undecided
  denied,   // a parent is drawn, so the node must not be replaced
};

// Decides by the rules for nodes with several parents. For a node with one parent they never intervene.
class Front {
 public:
  // The references must outlive the front. Empties the queue.
  Front(FrameScene& scene, DistanceQueue& queue, DrawRecorder& draws);

  void reach_roots();
  // Returns the number of nodes that have been reached in this frame.
  [[nodiscard]] std::uint32_t reached() const noexcept { return reached_; }
  [[nodiscard]] Permission may_refine(NodeRef n);
  // Replaces a node by its children: reaches new ones, and draws the patches of others that had to wait for this.
  void refine(NodeRef n);
  // Puts a node aside; it returns to the queue when its undecided parent is decided.
  void hold(NodeRef n);
  // Draws the patches of the node that its parents allow.
  void stop(NodeRef n);
  // Draws a node that may be refined, refined within so that its error is at most `max_error`, in object units.
  void stop_within(NodeRef n, double max_error);
  void cull(NodeRef n);
  // Marks a refined node as hidden after all, and the nodes below it that no other node reaches as gone.
  void hide(NodeRef n);
  // Marks the node, and all nodes through which it was reached, as visible in this frame.
  void see(NodeRef n);
  // Lets the drawn nodes that keep this node from being refined be refined in the next frame.
  void raise_floors(NodeRef n);
  // Renews the floors that let the parents of this node be refined.
  void keep_floors(NodeRef n);

 private:
  void reach(NodeRef n);
  void requeue_held(NodeState& state, std::uint32_t object);
  [[nodiscard]] bool is_gone(NodeRef n) const;
  Status resolve(NodeRef n);
  template <typename Visit>
  void for_each_parent(NodeRef n, const Visit& visit) const;

  FrameScene& scene_;
  DistanceQueue& queue_;
  DrawRecorder& draws_;
  std::uint32_t reached_ = 0;
  NodeRef undecided_;  // undecided node that resolve() found last
};

// Names a node to query.
struct AskedNode {
  NodeRef ref;
  double pixels = 0.0;  // number of pixels that its box covers on an empty screen
};

struct AnsweredNode {
  NodeRef ref;
  double pixels = 0.0;
  std::uint32_t visible = 0;  // pixels
  bool was_asked = true;      // false when the query did not pay off: the node counts as visible
};

class Questions {
 public:
  // The references must outlive the frame.
  void begin_frame(FrameScene& scene, Policy& policy, RenderDevice& device, Frame& frame);
  // Sets NodeState::through_hole of the nodes that were queried; is called after the last draw of a frame.
  // O(queries + draws).
  void mark_holes();

  // Makes a query now or later, as the policy says. `was_visible` tells that nothing waits for the answer.
  void ask(const AskedNode& n, bool was_visible);
  // Returns whether next() should be called now. `idle` tells that there is nothing else to do.
  [[nodiscard]] bool may_look(bool idle);
  // Waits for the answer to the oldest query and returns it. A group that is visible is first queried node by node.
  [[nodiscard]] AnsweredNode next();
  // Makes a deferred query when nothing else is left to do. Returns whether there was any.
  bool ask_waiting();

 private:
  struct Question {
    AskedNode node;
    QueryId query = 0;
    std::uint32_t visible = 0;  // pixels, if is_known
    bool is_known = false;
    bool was_asked = true;
    std::size_t draws = 0;    // number of draws before it in this frame
    std::uint32_t group = 1;  // number of nodes, from this one on, that share the query
  };
  [[nodiscard]] AskedNode with_pixels(NodeRef n) const;
  [[nodiscard]] double distance_of(NodeRef n) const;
  void keep(const AskedNode& n);
  void ask_singly(const AskedNode& n);
  void ask_round();
  void ask_groups();
  bool ask_kept(bool is_waiting);
  void settle_group();
  [[nodiscard]] bool is_gone(const Question& question) const;
  [[nodiscard]] bool is_answered(const Question& question);

  FrameScene* scene_ = nullptr;
  Policy* policy_ = nullptr;
  RenderDevice* device_ = nullptr;
  Frame* frame_ = nullptr;
  std::vector<Question> asked_;  // in this frame, answered ones included
  std::size_t settled_ = 0;      // number of entries of asked_ that are settled
  std::vector<AskedNode> kept_;  // for the next round; with `late` or groups, formerly visible nodes, for idle moments
  std::size_t kept_asked_ = 0;   // number of entries of kept_ that were queried
  std::vector<AskedNode> last_;  // with `late` or groups: formerly visible nodes for when all other answers are there
  DistanceQueue urgent_;         // with `late`: nodes that were not visible, for when there is nothing else to do
  std::vector<NodeRef> hidden_;  // with groups: nodes that were not visible
  std::vector<BoxRef> boxes_;    // of the query that is being made
};

// Keeps memory from frame to frame.
struct TraversalMemory {
  DistanceQueue reached;
  CutCache cuts;
  Questions questions;
};

// Runs the loop that strategies share, with one queue of nodes by distance and one of queries in order (Bittner and
// others 2004; Charalambos 2006, sec. 2.2.1; Charalambos and others 2007, fig. 2).
class Traversal {
 public:
  // The references must outlive the traversal. `scene` and `device` have begun their frame.
  Traversal(FrameScene& scene, Policy& policy, RenderDevice& device, TraversalMemory& memory, Frame& frame);

  void run();

 private:
  void visit(const ReachedNode& reached);
  void predict(const ReachedNode& reached);
  void act(const ReachedNode& reached, Action action);
  void ask(NodeRef n, double pixels, bool was_visible);
  void settle_next();
  void settle_hidden(NodeRef n);
  void settle_unasked(NodeRef n);
  void see_unasked(NodeRef n);
  void stop(NodeRef n, double bias);
  void draw_whole(NodeRef n, double bias);
  void settle(NodeRef n, double mu);
  void settle_held(NodeRef n, double bias);
  void settle_drawn(NodeRef n, bool is_fine, double bias);
  bool draw_finer(NodeRef n, double bias);
  [[nodiscard]] bool is_drawable(NodeRef n) const;
  void want_refined(NodeRef n);
  void draw_unrefined(NodeRef n);
  void note_denied(NodeRef n);
  void note_waiting(NodeRef n, double bias);
  void note_delayed(NodeRef n);
  void note_wasted(NodeRef n);

  FrameScene& scene_;
  Policy& policy_;
  RenderDevice& device_;
  TraversalMemory& memory_;
  FrameStats& stats_;
  std::vector<NodeAnswer>& asked_;
  DrawRecorder draws_;
  Front front_;
};

}  // namespace occlod::hlod
